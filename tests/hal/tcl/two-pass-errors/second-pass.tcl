loadrt or2 names=b
setp nosuch 1
