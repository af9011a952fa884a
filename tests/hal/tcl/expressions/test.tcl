# The value of setp and sets is an expression; that of `hal setp` is not.
loadrt sum2
newsig s float
set radius 2.0
setp sum2.0.in0 6.28/360.0*$radius*60.0
puts [getp sum2.0.in0]
setp sum2.0.in0 "1 + 2 * 3"
puts [getp sum2.0.in0]
setp sum2.0.in0 {sqrt($radius * 8) + [llength {a b c}]}
puts [getp sum2.0.in0]
setp sum2.0.in0 0x10
puts [getp sum2.0.in0]
sets s {1.0/3}
puts [hal gets s]
sets s 2**10
puts [hal gets s]
loadrt and2
foreach value {TRUE false 1 0 1==1 true&&false !0} {
  setp and2.0.in0 $value
  puts "$value [getp and2.0.in0]"
}
puts [catch {setp sum2.0.in0 abc} m]:[lindex [split $m \n] 0]
puts [catch {setp sum2.0.in0 1 + 2} m]:$m
puts [catch {setp sum2.0.in0} m]:$m
puts [catch {sets s} m]:$m
puts [catch {setp sum2.0.in0 1/0} m]:$m
puts [catch {setp and2.0.in0 2.5}]
puts [catch {hal setp sum2.0.in0 1+2} m]:$m
hal setp sum2.0.in0 7
puts [getp sum2.0.in0]
