puts "in inner"
setp nosuch 1
