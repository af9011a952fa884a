# watch.tcl: velocity and acceleration of every joint, from its position. For [HAL]TWOPASS: ddt is loaded on two lines here, and
# perhaps by other files.
#
#   halcmd show sig j0-*

set joints {}
for {set j 0} {$j < $::KINS(JOINTS)} {incr j} {
  lappend joints $j
}
loadrt ddt names=[join [lmap j $joints {set _ vel-$j}] ,]
loadrt ddt names=[join [lmap j $joints {set _ acc-$j}] ,]
loadrt scale names=[join [lmap j $joints {set _ permille-$j}] ,]

foreach j $joints {
  foreach component {vel acc permille} {
    addf $component-$j servo-thread
  }
  net j$j-pos-cmd  =>  vel-$j.in
  net j$j-vel      vel-$j.out  =>  acc-$j.in  permille-$j.in
  net j$j-acc      acc-$j.out
  # Of the joint's full speed
  net j$j-permille permille-$j.out
  setp permille-$j.gain 1000.0/[lindex [set ::JOINT_${j}(MAX_VELOCITY)] 0]
}
