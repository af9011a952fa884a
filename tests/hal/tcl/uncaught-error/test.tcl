# An uncaught error ends the script; file and line come first.
puts before
proc connect {pin} {
  net x $pin
}
if {1} {
  connect nosuch.pin
}
puts after
