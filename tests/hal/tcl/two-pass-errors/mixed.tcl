loadrt and2 count=1
foreach name {x y} {
  loadrt and2 names=$name
}
