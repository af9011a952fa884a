# Tcl has substituted and split what is to be; halcmd's own rules do not come on top.
newsig {$HOME} bit
newsig {[KINS]JOINTS} bit
newsig {#sign} bit
newsig "\"quoted\"" bit
newsig a\\b bit
foreach name [list {$HOME} {[KINS]JOINTS} {#sign} "\"quoted\"" a\\b] {
  sets $name 1
  puts "$name [hal gets $name]"
}
loadrt and2 names=a,b
# One word is one word.
puts [catch {net x {a.in0 b.in0}} m]:$m
net x {*}[list a.in0 b.in0]
puts "<[hal list pin a.i*]>"
