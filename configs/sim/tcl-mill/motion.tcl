# motion.tcl: the motion controller and a simulated motor for each joint, however many [KINS]JOINTS says.
#
# Every halcmd command is a Tcl command here; `list` and `gets` are Tcl's own, so HAL's are `hal list` and `hal gets`. A value of
# the INI file is $::SECTION(KEY). It is a list of all values of that key; for a single word that makes no difference.

loadrt $::KINS(KINEMATICS)
loadrt $::EMCMOT(EMCMOT) servo_period_nsec=$::EMCMOT(SERVO_PERIOD) num_joints=$::KINS(JOINTS) num_spindles=$::TRAJ(SPINDLES)

set motors {}
for {set j 0} {$j < $::KINS(JOINTS)} {incr j} {
  lappend motors motor-$j
}
loadrt sim-axis names=[join $motors ,]

addf motion-command-handler servo-thread
addf motion-controller servo-thread

# The value of an INI key, or another one when the key is missing.
proc ini_value {section key fallback} {
  upvar #0 $section values
  if {[info exists values($key)]} {
    return [lindex $values($key) 0]
  }
  return $fallback
}

for {set j 0} {$j < $::KINS(JOINTS)} {incr j} {
  set motor motor-$j
  addf $motor servo-thread
  net j$j-enable   joint.$j.amp-enable-out  =>  $motor.enable
  net j$j-pos-cmd  joint.$j.motor-pos-cmd   =>  $motor.pos-cmd
  net j$j-pos-fb   $motor.pos-fb            =>  joint.$j.motor-pos-fb
  # A joint without switches, such as a rotary table, homes where it stands.
  if {[ini_value JOINT_$j HOME_SEARCH_VEL 0] == 0} {
    continue
  }
  net j$j-home-sw    $motor.home-sw     =>  joint.$j.home-sw-in
  net j$j-limit-neg  $motor.neg-lim-sw  =>  joint.$j.neg-lim-sw-in
  net j$j-limit-pos  $motor.pos-lim-sw  =>  joint.$j.pos-lim-sw-in
  # The second word of setp is an expression.
  setp $motor.home-switch-pos       [ini_value JOINT_$j SIM_HOME_SWITCH 0]
  setp $motor.home-switch-positive  "[ini_value JOINT_$j HOME_SEARCH_VEL 0] > 0"
  setp $motor.neg-limit-pos         [ini_value JOINT_$j SIM_NEG_LIMIT -1e9]
  setp $motor.pos-limit-pos         [ini_value JOINT_$j SIM_POS_LIMIT 1e9]
}
