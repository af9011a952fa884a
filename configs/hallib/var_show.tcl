# var_show.tcl: prints the INI values and the arguments that a Tcl HAL file sees.
puts "argv: [expr {[info exists ::argv] ? $::argv : {}}]"
foreach name [lsort [info globals {[A-Z]*}]] {
  if {![array exists ::$name]} continue
  foreach key [lsort [array names ::$name]] { puts "::${name}($key) = [set ::${name}($key)]" }
}
