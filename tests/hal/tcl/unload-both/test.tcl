# unload is HAL's for components and Tcl's for libraries.
loadrt and2
unload and2
puts "<[hal list pin and2*]>"
puts [catch {unload nosuch}]
puts [catch {unload /nosuch/library.so} m]:$m
puts [catch {unload} m]:$m
