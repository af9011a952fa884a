# hal_procs_lib.tcl: questions about HAL for other Tcl HAL files.

proc pin_exists {name} { return [expr {$name in [hal list pin $name]}] }
proc is_connected {name {signal_name {}}} {
  if {$signal_name ne {}} { upvar 1 $signal_name signal }
  set signal {}
  foreach line [split [hal show pin $name] \n] {
    if {[regexp {^\s*\S+\s+\S+\s+(\S+)\s+\S+\s+(\S+)\s+(<==|==>|<=>)\s+(\S+)} $line -> dir pin arrow signal] && $pin eq $name} {
      return [string map {IN is_input OUT is_output I/O is_io} $dir]
    }
  }
  return not_connected
}
