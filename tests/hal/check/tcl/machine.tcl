loadrt and2
