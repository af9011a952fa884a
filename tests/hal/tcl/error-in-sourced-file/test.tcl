source inner.tcl
puts after
