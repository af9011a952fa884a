loadrt threads name1=servo period1=1000000
for {set j 0} {$j < $::KINS(JOINTS)} {incr j} {lappend names gain-$j}
loadrt sum2 names=[join $names ,]
for {set j 0} {$j < $::KINS(JOINTS)} {incr j} {
  set gain [set ::JOINT_${j}(GAIN)]
  addf gain-$j servo
  setp gain-$j.gain0 $gain*2
  setp gain-$j.gian1 $gain
}
if {[lindex $argv 1] eq "two"} {
  loadrt and2 names=spindle
  addf spindle servo
  net spindle-on spindle.outt
} else {
  loadrt nothing
}
if {[info exists ::PANEL(LAMP)]} {
  source lamp.hal
}
if {[catch {loadrt no_such_module}]} {
  loadrt not names=instead
  addf instead servo
}
exec touch a-check-wrote-this
puts "not printed"
after 100000
set was [getp gain-0.gain0]
if {$was == 3.0} {net was-three gain-0.out}
net two gain-0.out
expr {1 +}
