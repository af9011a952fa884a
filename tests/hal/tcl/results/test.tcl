# A command's result is what it says or the value it reads.
loadrt and2 names=a,b
newsig level float
puts "<[sets level 2.5]>"
puts "<[hal gets level]> <[stype level]>"
puts "<[setp a.in0 1]>"
puts "<[getp a.in0]> <[ptype a.in0]>"
puts "<[net x a.out => b.in0 b.in1]>"
puts "<[unlinkp b.in1]>"
puts "<[hal list pin b*]>"
puts "<[hal list pin nothing*]>"
puts "[llength [hal list pin]] pins, the first is [lindex [hal list pin] 0]"
