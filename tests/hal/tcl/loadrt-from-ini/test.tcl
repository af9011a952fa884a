# A value with blanks is a list of one element, as the manual says; loadrt takes it all the same.
loadrt $::KINS(KINEMATICS)
loadrt [lindex $::OTHER(MODULE) 0]
loadrt {*}[lindex $::THIRD(MODULE) 0]
loadrt sum2 names=[join {p q} ,]
puts [hal list funct]
