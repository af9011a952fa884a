# A failed command is a Tcl error with halcmd's message; the script may catch it and go on.
loadrt and2 names=gate
puts "[catch {getp gate.in9} message] $message"
puts "[catch {net x gate.out nopin} message] $message"
puts "[catch {hal list} message] $message"
foreach command {
  {getp gate.in9}
  {setp gate.out 1}
  {net x}
  {net x gate.out nopin}
  {net x gate.out gate.outt}
  {hal gets nosig}
  {newsig x nosuchtype}
  {loadrt nosuch}
  {loadrt and2}
  {unloadrt nosuch}
  {addf gate nothread}
  {show nonsense}
  {newsig}
  {hal list}
  {waitusr}
} {
  set code [catch $command message options]
  puts "$command -> $code [dict get $options -errorcode] [expr {$message ne {}}]"
}
# All or nothing: net x made no signal.
puts "signals: <[hal list sig]>"
