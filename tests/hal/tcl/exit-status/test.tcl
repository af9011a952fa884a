loadrt and2
puts [getp and2.0.in0]
exit 7
