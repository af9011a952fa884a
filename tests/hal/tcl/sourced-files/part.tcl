set made 5; newsig tclsig bit; return 7
