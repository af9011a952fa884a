

loadrt and2 names=b,a
