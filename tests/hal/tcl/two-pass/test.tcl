# loadrt lines of all files are put together; the rest is done in order, once.
puts [catch {loadusr -w haltcl -i test.ini --twopass on,verbose,nodelete one.hal ";" two.tcl A "B C" ";" three.hal} m]
puts $m
puts "functions: [hal list funct]"
puts "signals: <[hal list sig]>"
