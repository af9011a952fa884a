# halcheck.tcl: says what is often forgotten in HAL files. Make it the last HALFILE.
#
#   HALFILE = LIB:halcheck.tcl [nopopup]
#
# Reports realtime functions that no thread runs, and signals without a writer or without a reader. Kerf shows no window, so nopopup
# changes nothing. Connections of POSTGUI_HALFILE are made later and are not seen.
set report {}

set in_threads {}
foreach line [split [hal show thread] \n] {
  if {[regexp {^\s+\d+\s+(\S+)\s*$} $line -> function]} { lappend in_threads $function }
}
set idle {}
foreach function [hal list funct] {
  if {$function ni $in_threads} { lappend idle $function }
}
if {[llength $idle] > 0} { lappend report "Functions without addf:" {*}[lmap f $idle { string cat "    " $f }] }

set no_writer {}
set no_reader {}
foreach signal [hal list sig] {
  set writers 0
  set readers 0
  foreach line [split [hal show sig $signal] \n] {
    if {[regexp {^\s+(<==|==>|<=>)\s+\S+} $line -> arrow]} {
      if {$arrow ne "==>"} { incr writers }
      if {$arrow ne "<=="} { incr readers }
    }
  }
  if {$writers == 0} { lappend no_writer $signal }
  if {$readers == 0} { lappend no_reader $signal }
}
if {[llength $no_writer] > 0} { lappend report "Signals with no output:" {*}[lmap s $no_writer { string cat "    " $s }] }
if {[llength $no_reader] > 0} { lappend report "Signals with no inputs:" {*}[lmap s $no_reader { string cat "    " $s }] }

puts "[file tail [info script]]: [expr {[llength $report] == 0 ? {nothing found} : [join $report \n]}]"
