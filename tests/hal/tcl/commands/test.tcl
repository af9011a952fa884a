# Every word that the manual documents for haltcl is there, plain or after `hal`.
set documented {addf alias delf delsig getp gets ptype stype help linkpp linkps linksp list loadrt loadusr lock net newsig save
  setp sets show source start status stop unalias unlinkp unload unloadrt unloadusr unlock waitusr}
set known [hal --commands]
foreach word $documented {
  if {$word ni $known} {puts "hal --commands lacks $word"}
  if {[info commands $word] eq ""} {puts "no command $word"}
}
# Tcl's own are not disturbed.
puts [list a {b c} d]
puts "[info procs gets] [catch {gets stdin} n] $n"
puts [catch {hal} m]:$m
puts [catch {hal foo} m]:$m
puts [catch {hal --commands extra} m]:[expr {$m eq $known}]
puts [catch {netx a} m]:$m
