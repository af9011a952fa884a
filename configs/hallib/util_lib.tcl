# util_lib.tcl: what several Tcl HAL files use.
source [file join [file dirname [info script]] sim_lib.tcl]
