# sim_machine.tcl: a whole simulated machine from its INI file alone: kinematics, motion controller, and for each joint a motor
# with home and limit switches, for each spindle a motor with encoder.
#
#   HALFILE = LIB:sim_machine.tcl
#   HALFILE = LIB:sim_panel.hal        emergency stop, tool changer, coolant
#
# Joint N is the component `motor-N` (sim-axis), spindle N `spindle-N` (sim_spindle). A key SIM_SOME_THING of [JOINT_N] or
# [SPINDLE_N] sets their parameter some-thing: SIM_HOME_SWITCH_POS = -60 is `setp motor-0.home-switch-pos -60`.
# A joint without SIM_HOME_SWITCH_POS has no home switch.
#
# Signals: jN-enable jN-pos-cmd jN-pos-fb jN-home-sw jN-limit-neg jN-limit-pos jN-index, spindle-N-speed-cmd spindle-N-revs
# spindle-N-speed-fb spindle-N-at-speed spindle-N-index spindle-N-orient spindle-N-orient-angle spindle-N-is-oriented.
source [file join [file dirname [info script]] sim_lib.tcl]

# The keys, by name, so that `kerf check` finds a wrong one.
set sim_joint_keys {
  SIM_HOME_SWITCH_POS SIM_HOME_SWITCH_WIDTH SIM_HOME_SWITCH_POSITIVE SIM_HOME_SWITCH_HYSTERESIS SIM_NEG_LIMIT_POS SIM_POS_LIMIT_POS
  SIM_SWITCH_BOUNCE SIM_INDEX_PITCH SIM_LAG SIM_MAX_VELOCITY SIM_INERTIA SIM_BANDWIDTH SIM_MAX_FORCE SIM_FRICTION SIM_DAMPING
}
set sim_spindle_keys {SIM_ACCELERATION SIM_AT_SPEED_TOLERANCE SIM_ORIENT_SPEED SIM_ENCODER_COUNTS}

# Gives the parameters of `component` what the keys of `section` say.
proc sim_parameters {section keys component} {
  foreach key $keys {
    set value [sim_ini $section $key]
    if {$value eq {}} continue
    set parameter [string map {_ -} [string tolower [string range $key 4 end]]]
    sim_do setp $component.$parameter [expr {[string is double -strict $value] ? $value : [string is true $value]}]
  }
}

proc sim_motor {j} {
  set motor motor-$j
  sim_addf $motor
  sim_do net j$j-enable joint.$j.amp-enable-out => $motor.enable
  sim_do net j$j-pos-cmd joint.$j.motor-pos-cmd => $motor.pos-cmd
  sim_do net j$j-pos-fb $motor.pos-fb => joint.$j.motor-pos-fb
  sim_do net j$j-limit-neg $motor.neg-lim-sw => joint.$j.neg-lim-sw-in
  sim_do net j$j-limit-pos $motor.pos-lim-sw => joint.$j.pos-lim-sw-in
  sim_do net j$j-index joint.$j.index-enable <=> $motor.index-enable
  if {[sim_ini JOINT_$j SIM_HOME_SWITCH_POS] ne {}} { sim_do net j$j-home-sw $motor.home-sw => joint.$j.home-sw-in }
  sim_parameters JOINT_$j $::sim_joint_keys $motor
}

proc sim_spindle_motor {n} {
  set motor spindle-$n
  sim_addf $motor
  sim_do net spindle-$n-speed-cmd spindle.$n.speed-out-rps => $motor.velocity-cmd
  sim_do net spindle-$n-revs $motor.position-fb => spindle.$n.revs
  sim_do net spindle-$n-speed-fb $motor.velocity-fb => spindle.$n.speed-in
  sim_do net spindle-$n-at-speed $motor.at-speed => spindle.$n.at-speed
  sim_do net spindle-$n-index spindle.$n.index-enable <=> $motor.index-enable
  sim_do net spindle-$n-orient spindle.$n.orient => $motor.orient
  sim_do net spindle-$n-orient-angle spindle.$n.orient-angle => $motor.orient-angle
  sim_do net spindle-$n-is-oriented $motor.is-oriented => spindle.$n.is-oriented
  sim_parameters SPINDLE_$n $::sim_spindle_keys $motor
}

setup_kins
load_motmod
set joints [sim_joints]
sim_do loadrt sim-axis names=[join [lmap j $joints { string cat motor-$j }] ,]
foreach j $joints { sim_motor $j }
set spindles {}
for {set n 0} {$n < [sim_ini TRAJ SPINDLES 1]} {incr n} { lappend spindles $n }
sim_do loadrt sim_spindle names=[join [lmap n $spindles { string cat spindle-$n }] ,]
foreach n $spindles { sim_spindle_motor $n }
