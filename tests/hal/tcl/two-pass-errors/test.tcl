# Errors of both passes name file and line, and end it all.
foreach files {
  {mixed.hal}
  {mixed.tcl}
  {twice.hal ";" names.tcl}
  {nomodule.hal}
  {bad-substitution.hal}
  {second-pass.hal ";" never.tcl}
  {second-pass.tcl ";" never.tcl}
  {leaves.tcl ";" never.tcl}
  {nosuch.hal}
} {
  puts "--- $files: [catch "loadusr -w haltcl --twopass on $files" m] $m"
}
puts "functions: <[hal list funct]>"
