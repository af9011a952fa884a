package ifneeded Hal 1.0 [list load [file join $dir libhaltcl.so] Hal]
