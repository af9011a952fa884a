# hookup_moveoff.tcl: puts the component moveoff (as mv) between motion control and what drives and measures the joints.
#
# It follows the HAL files that connect joint.N.motor-pos-cmd and joint.N.motor-pos-fb. Settings come from [MOVEOFF] and
# [MOVEOFF_N], else from [OFFSET] and the OFFSET_ keys of [AXIS_L], else the limits of the axis are taken.
source [file join [file dirname [info script]] sim_lib.tcl]

# The first of several keys that the INI file has; each is {SECTION KEY}.
proc moveoff_value {places} {
  foreach place $places {
    set value [sim_ini {*}$place]
    if {$value ne {}} { return $value }
  }
  return {}
}

proc moveoff_set {pin places} {
  set value [moveoff_value $places]
  if {$value ne {}} { hal setp mv.$pin $value }
}

# Name of the signal at a pin, or "".
proc signal_at {pin} {
  foreach line [split [hal show pin $pin] \n] {
    if {[regexp {^\s*\S+\s+\S+\s+\S+\s+\S+\s+(\S+)\s+(<==|==>|<=>)\s+(\S+)} $line -> name arrow signal] && $name eq $pin} {
      return $signal
    }
  }
  return {}
}

# All pins at a signal.
proc pins_at {signal} {
  set pins {}
  foreach line [split [hal show sig $signal] \n] {
    if {[regexp {^\s+(<==|==>|<=>)\s+(\S+)} $line -> arrow pin]} { lappend pins $pin }
  }
  return $pins
}

# Gives each pin of the signal at `pin`, but for that pin, to another signal.
proc move_others {pin from to} {
  if {$from eq {}} return
  foreach other [pins_at $from] {
    hal unlinkp $other
    if {$other ne $pin} { hal net $to $other }
  }
  hal delsig $from
}

set joints [sim_ini KINS JOINTS 0]
if {[sim_ini HAL HALUI] eq {}} {
  puts stderr "hookup_moveoff.tcl: moveoff_gui needs \[HAL\]HALUI = halui"
}
if {$joints < 1 || $joints > 9} { error "hookup_moveoff.tcl: \[KINS\]JOINTS must be 1 to 9" }

hal loadrt moveoff names=mv personality=$joints
# Before all others and behind the controller: offsets come in within the same cycle.
hal addf mv.read-inputs servo-thread 1
set position 1
foreach line [split [hal show thread servo-thread] \n] {
  if {[regexp {^\s+(\d+)\s+motion-controller\s*$} $line -> at]} { set position [expr {$at + 1}] }
}
hal addf mv.write-outputs servo-thread $position

for {set j 0} {$j < $joints} {incr j} {
  set command [signal_at joint.$j.motor-pos-cmd]
  set feedback [signal_at joint.$j.motor-pos-fb]
  if {$command eq $feedback && $command ne {}} {
    # A motor that follows at once: the command, with its offset, is also the feedback.
    hal unlinkp joint.$j.motor-pos-fb
    move_others joint.$j.motor-pos-cmd $command hu:plus-$j
    hal net hu:plus-$j mv.pos-plusoffset-$j => mv.fb-$j
  } else {
    move_others joint.$j.motor-pos-cmd $command hu:plus-$j
    move_others joint.$j.motor-pos-fb $feedback hu:fb-$j
    hal net hu:plus-$j <= mv.pos-plusoffset-$j
    hal net hu:fb-$j => mv.fb-$j
  }
  hal net hu:pos-$j joint.$j.motor-pos-cmd => mv.pos-$j
  hal net hu:minus-$j mv.fb-minusoffset-$j => joint.$j.motor-pos-fb

  set axis AXIS_[lindex [regexp -all -inline {[A-Z]} [string toupper [join [sim_ini_words TRAJ COORDINATES {X Y Z}] {}]]] $j]
  foreach {pin key} {offset-max MAX_LIMIT offset-min MIN_LIMIT offset-vel MAX_VELOCITY offset-accel MAX_ACCELERATION} {
    moveoff_set $pin-$j [list [list MOVEOFF_$j $key] [list $axis OFFSET_$key] [list $axis $key]]
  }
}
moveoff_set epsilon {{MOVEOFF EPSILON} {OFFSET EPSILON}}
moveoff_set waypoint-sample-secs {{MOVEOFF WAYPOINT_SAMPLE_SECS} {OFFSET WAYPOINT_SAMPLE_SECS}}
moveoff_set waypoint-threshold {{MOVEOFF WAYPOINT_THRESHOLD} {OFFSET WAYPOINT_THRESHOLD}}
moveoff_set backtrack-enable {{MOVEOFF BACKTRACK_ENABLE} {OFFSET BACKTRACK_ENABLE}}
