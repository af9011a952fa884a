# source takes both languages by their endings; `hal source` is halcmd's.
loadrt and2 names=a
puts "result of a Tcl file: [source part.tcl]"
puts "from part.tcl: $made"
puts "result of a HAL file: <[source part.hal]>"
puts "[hal list sig]"
hal source more.hal
puts "[hal list sig]"
puts [catch {source nosuch.tcl} m]:$m
puts [catch {source nosuch.hal} m]:$m
puts [catch {source broken.hal} m]:$m
