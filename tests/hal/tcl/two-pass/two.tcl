puts "two.tcl: $argc arguments, second <[lindex $argv 1]>, pins of aa: [llength [hal list pin aa.*]]"
loadrt and2 names=ab,ac
loadrt or2 count=2
loadrt sampler cfg=ff depth=100
# In the first pass these do nothing, whatever they are about.
puts "getp <[getp ab.in0]> setp <[setp ab.in0 1]> net <[net two ab.in1]>"
foreach name {ab ac} {
  addf $name servo
}
lappend seen once
puts "seen $seen in pass [::tp::passnumber]"
loadusr -w echo "two.tcl's program"
