# wheeljogpins.tcl: enables jogging by wheel counts for every axis and joint.
#
#   HALFILE = LIB:wheeljogpins.tcl [SCALE]
#
# SCALE, 0.1 when absent, is the distance of one count.
set scale [expr {[info exists ::argv] && [llength $::argv] > 0 ? [lindex $::argv 0] : 0.1}]
if {![string is double -strict $scale]} { error "wheeljogpins.tcl: '$scale' is no number for the distance of a count" }
foreach pin [hal list pin] {
  if {[regexp {^(axis\.[a-z]|joint\.\d+)\.jog-scale$} $pin -> what]} {
    hal setp $pin $scale
    hal setp $what.jog-enable 1
  }
}
