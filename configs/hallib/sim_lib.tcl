# sim_lib.tcl: what basic_sim.tcl is made of; other Tcl HAL files may use it too:
#
#   source [file join $::env(HALLIB_DIR) sim_lib.tcl]
#   setup_kins
#   core_sim {0 1 2}
#
# Each command goes through `sim_do`, which notes it for write_equivalent_hal_file.

# Values of the INI file: the first of a key, or `fallback`.
proc sim_ini {section key {fallback {}}} {
  upvar #0 $section values
  if {[info exists values($key)]} { return [lindex $values($key) 0] }
  return $fallback
}

# The words of a command line that stands as one value in the INI file, such as "trivkins coordinates=XYZ".
proc sim_ini_words {section key {fallback {}}} {
  upvar #0 $section values
  if {![info exists values($key)]} { return $fallback }
  return [regexp -all -inline {\S+} [join $values($key)]]
}

proc sim_joints {} {
  set joints {}
  for {set j 0} {$j < [sim_ini KINS JOINTS 0]} {incr j} { lappend joints $j }
  return $joints
}

# Joint of an axis letter in a machine of trivkins; of several the last. "" when there is none, or other kinematics.
proc sim_joint_of_axis {letter} {
  set words [sim_ini_words KINS KINEMATICS]
  if {[lindex $words 0] ne "trivkins"} { return {} }
  set coordinates xyzabcuvw
  foreach word $words {
    if {[regexp -nocase {^coordinates=(.*)$} $word -> letters]} { set coordinates $letters }
  }
  set joint [string last $letter [string tolower $coordinates]]
  if {$joint < 0 || $joint >= [sim_ini KINS JOINTS 0]} { return {} }
  return $joint
}

set ::sim_commands {}

# Does a HAL command and notes it.
proc sim_do args {
  lappend ::sim_commands $args
  uplevel #0 [list hal {*}$args]
}

proc sim_addf {functions} {
  foreach function $functions { sim_do addf $function servo-thread }
}

# ---------------------------------------------------------------------------------------------------- parts of a machine

proc setup_kins {{axes {}}} {
  set words [sim_ini_words KINS KINEMATICS]
  if {[llength $words] == 0} { error "no \[KINS\]KINEMATICS in the INI file" }
  sim_do loadrt {*}$words
}

# The motion controller as the INI file wants it, in servo-thread.
proc load_motmod {} {
  set servo_ns [sim_ini EMCMOT SERVO_PERIOD 1000000]
  set base_ns [sim_ini EMCMOT BASE_PERIOD 0]
  set more {}
  if {[sim_ini TRAJ SPINDLES] ne {}} { lappend more num_spindles=[sim_ini TRAJ SPINDLES] }
  sim_do loadrt {*}[sim_ini_words EMCMOT EMCMOT motmod] base_period_nsec=$base_ns servo_period_nsec=$servo_ns \
    num_joints=[sim_ini KINS JOINTS] {*}$more
  sim_addf {motion-command-handler motion-controller}
}

# Motion control, and for each joint a motor that follows at once while the machine is on and stays where it is while it is off.
proc core_sim {{joints {}}} {
  if {[llength $joints] == 0} { set joints [sim_joints] }
  load_motmod
  sim_do loadrt pid names=[join [lmap j $joints { string cat J${j}_pid }] ,]
  sim_do loadrt mux2 names=[join [lmap j $joints { string cat J${j}_mux }] ,]
  sim_addf [lmap j $joints { string cat J${j}_pid.do-pid-calcs }]
  sim_addf [lmap j $joints { string cat J${j}_mux }]
  foreach j $joints {
    # The position is the command itself: no more than a feed forward of one. (Pgain is 1 unless it is set, and nothing is fed back.)
    sim_do setp J${j}_pid.Pgain 0
    sim_do setp J${j}_pid.FF0 1
    sim_do net J$j:enable joint.$j.amp-enable-out => J${j}_pid.enable
    sim_do net J$j:pos-cmd joint.$j.motor-pos-cmd => J${j}_pid.command
    sim_do net J$j:on-pos J${j}_pid.output => J${j}_mux.in1
    sim_do net J$j:pos-fb J${j}_mux.out => J${j}_mux.in0 joint.$j.motor-pos-fb
    sim_do net sample:enable motion.motion-enabled => J${j}_mux.sel
  }
  sim_do net estop:loop iocontrol.0.user-enable-out => iocontrol.0.emc-enable-in
}

# Velocity and acceleration of each joint; speed in the XY plane and in space.
proc make_ddts {{joints {}}} {
  if {[llength $joints] == 0} { set joints [sim_joints] }
  set names {}
  foreach j $joints { lappend names J${j}_vel J${j}_accel }
  sim_do loadrt ddt names=[join $names ,]
  sim_addf $names
  foreach j $joints {
    sim_do net J$j:pos-fb => J${j}_vel.in
    sim_do net J$j:vel J${j}_vel.out => J${j}_accel.in
    sim_do net J$j:acc <= J${j}_accel.out
  }
  set x [sim_joint_of_axis x]
  set y [sim_joint_of_axis y]
  set z [sim_joint_of_axis z]
  if {$x eq {} || $y eq {}} return
  set space [expr {$z ne {}}]
  sim_do loadrt hypot names=[expr {$space ? "hyp_xy,hyp_xyz" : "hyp_xy"}]
  sim_addf [expr {$space ? {hyp_xy hyp_xyz} : {hyp_xy}}]
  sim_do net J$x:vel => hyp_xy.in0
  sim_do net J$y:vel => hyp_xy.in1
  sim_do net xy:vel <= hyp_xy.out
  if {!$space} return
  sim_do net J$x:vel => hyp_xyz.in0
  sim_do net J$y:vel => hyp_xyz.in1
  sim_do net J$z:vel => hyp_xyz.in2
  sim_do net xyz:vel <= hyp_xyz.out
}

# A home switch for each joint, one unit away from zero, on the side to which the joint searches; an index pulse where one is used.
proc simulated_home {{joints {}}} {
  if {[llength $joints] == 0} { set joints [sim_joints] }
  set names [lmap j $joints { string cat J${j}_switch }]
  sim_do loadrt sim_home_switch names=[join $names ,]
  sim_addf $names
  foreach j $joints {
    sim_do net J$j:pos-fb => J${j}_switch.cur-pos
    sim_do net J$j:homesw J${j}_switch.home-sw => joint.$j.home-sw-in
    if {[sim_ini JOINT_$j HOME_SEARCH_VEL 0] < 0} { sim_do setp J${j}_switch.home-pos -1.0 }
    if {[string match -nocase {[ty1]*} [sim_ini JOINT_$j HOME_USE_INDEX no]]} {
      sim_do net J$j:index-enable joint.$j.index-enable <=> J${j}_switch.index-enable
    }
  }
}

# The operator changes tools when hal_manualtoolchange is there and comes up; else a change ends at once, as with `loop`.
proc use_hal_manualtoolchange {} {
  sim_do net tool:prep-loop iocontrol.0.tool-prepare => iocontrol.0.tool-prepared
  sim_do loadusr -W hal_manualtoolchange
  sim_do net tool:change iocontrol.0.tool-change => hal_manualtoolchange.change
  sim_do net tool:changed iocontrol.0.tool-changed <= hal_manualtoolchange.changed
  sim_do net tool:prep-number iocontrol.0.tool-prep-number => hal_manualtoolchange.number
}

proc tool_change_loop {} {
  sim_do net tool:prep-loop iocontrol.0.tool-prepare => iocontrol.0.tool-prepared
  sim_do net tool:change-loop iocontrol.0.tool-change => iocontrol.0.tool-changed
}

# A spindle with an encoder that takes time to reach its speed.
proc sim_spindle {} {
  sim_do loadrt sim_spindle names=sim_spindle
  sim_do loadrt limit2 names=limit_speed
  sim_do loadrt lowpass names=spindle_mass
  sim_do loadrt near names=near_speed
  sim_do loadrt scale names=rpm_rps
  # rev/min to rev/s
  sim_do setp sim_spindle.scale 0.01666667
  sim_do setp rpm_rps.gain 0.0167
  # rpm a second, and the lag of the mass
  sim_do setp limit_speed.maxv 5000.0
  sim_do setp spindle_mass.gain 0.07
  # at speed: within 10 percent, or 10 rpm
  sim_do setp near_speed.scale 1.1
  sim_do setp near_speed.difference 10
  sim_do net spindle-speed-cmd spindle.0.speed-out => limit_speed.in near_speed.in1
  sim_do net spindle-speed-limited limit_speed.out => sim_spindle.velocity-cmd spindle_mass.in
  sim_do net spindle-rpm-filtered spindle_mass.out => rpm_rps.in near_speed.in2
  sim_do net spindle-rps-filtered rpm_rps.out => spindle.0.speed-in
  sim_do net spindle-at-speed near_speed.out => spindle.0.at-speed
  sim_do net spindle-index-enable spindle.0.index-enable <=> sim_spindle.index-enable
  sim_do net spindle-pos sim_spindle.position-fb => spindle.0.revs
  sim_do net spindle-orient spindle.0.orient => spindle.0.is-oriented
  sim_addf {limit_speed spindle_mass rpm_rps near_speed sim_spindle}
}

# -------------------------------------------------------------------------------------------------- the equivalent HAL file

# [SECTION]KEY in a line of a HAL file, replaced by its value.
proc sim_substitute {line} {
  set out {}
  while {[regexp -indices {\[([A-Za-z0-9_]+)\](\([^)]+\)|[A-Za-z0-9_]+)} $line all section key]} {
    set name [string trim [string range $line {*}$key] ()]
    set value [sim_ini [string range $line {*}$section] $name [string range $line {*}$all]]
    append out [string range $line 0 [expr {[lindex $all 0] - 1}]] $value
    set line [string range $line [expr {[lindex $all 1] + 1}] end]
  }
  return $out$line
}

# The commands of the HAL files before `self`, with the values of the INI file in them.
proc sim_commands_before {self} {
  set lines {}
  foreach file [expr {[info exists ::HAL(HALFILE)] ? $::HAL(HALFILE) : {}}] {
    regsub {^LIB:} [lindex [split $file] 0] {} name
    if {[file tail $name] eq $self} break
    if {[file extension $name] ne ".hal"} continue
    foreach folder [split $::env(HALLIB_PATH) :] {
      set path [file join $folder $name]
      if {![file isfile $path]} continue
      set in [open $path]
      foreach line [split [read $in] \n] {
        if {[regexp {^\s*(#|$)} $line]} continue
        lappend lines [sim_substitute [string trim $line]]
      }
      close $in
      break
    }
  }
  return $lines
}

# Writes what was done as INIFILE_cmds.hal beside the INI file; where that is not possible it is left.
proc write_equivalent_hal_file {self} {
  set path [file rootname $::env(INI_FILE_NAME)]_cmds.hal
  if {[catch {open $path w} out]} { return }
  puts $out "# The HAL commands of [file tail $::env(INI_FILE_NAME)]. Instead of LIB:$self write:\n#   HALFILE = ./[file tail $path]"
  foreach line [sim_commands_before $self] { puts $out $line }
  foreach words $::sim_commands { puts $out [join $words] }
  close $out
}
