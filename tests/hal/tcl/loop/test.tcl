# Velocity and acceleration of any number of joints, after the manual's example.
loadrt threads name1=servo period1=1000000
loadrt sum2 names=joint0,joint1,joint2
set count 0
foreach pin [hal list pin joint?.out] {incr count}
loadrt ddt count=[expr {2 * $count}]
set ddt 0
for {set jnum 0} {$jnum < 5} {incr jnum} {
  if {[hal list pin joint$jnum.out] == {}} {
    continue
  }
  net j${jnum}pos joint$jnum.out => ddt.$ddt.in
  net j${jnum}vel <= ddt.$ddt.out
  addf ddt.$ddt servo
  incr ddt
  net j${jnum}vel => ddt.$ddt.in
  net j${jnum}acc <= ddt.$ddt.out
  addf ddt.$ddt servo
  incr ddt
}
show sig *vel
start
puts "[hal list thread]: [hal list funct ddt*]"
stop
