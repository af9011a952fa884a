# show, save and help print to stdout, in order with puts; their result is empty.
loadrt and2 names=a
net x a.in0
puts before
set result [show sig]
puts "result <$result>"
puts [show pin a.in*]
puts after
puts "status: <[lindex [split [status lock] \n] 0]>"
