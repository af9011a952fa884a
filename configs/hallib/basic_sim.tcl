# basic_sim.tcl: a simulated machine with as many joints as [KINS]JOINTS says.
#
#   HALFILE = LIB:basic_sim.tcl [OPTION...]
#
#   -no_make_ddts              no velocities and accelerations (signals JN:vel, JN:acc, xy:vel, xyz:vel)
#   -no_simulated_home         no home switches
#   -no_use_hal_manualtoolchange   tool changes end at once, nobody is asked
#   -no_sim_spindle            no spindle with encoder
#
# The commands are written to INIFILE_cmds.hal beside the INI file: a copy of it is the start of a machine of one's own.
source [file join [file dirname [info script]] sim_lib.tcl]

set options [expr {[info exists ::argv] ? $::argv : {}}]
set known {-no_make_ddts -no_simulated_home -no_use_hal_manualtoolchange -no_sim_spindle}
foreach option $options {
  if {$option ni $known} { puts stderr "basic_sim.tcl: unknown option '$option'; known are [join $known {, }]" }
}

setup_kins
core_sim
if {"-no_make_ddts" ni $options} { make_ddts }
if {"-no_simulated_home" ni $options} { simulated_home }
if {"-no_use_hal_manualtoolchange" ni $options} {
  use_hal_manualtoolchange
} else {
  tool_change_loop
}
if {"-no_sim_spindle" ni $options} { sim_spindle }
write_equivalent_hal_file basic_sim.tcl
