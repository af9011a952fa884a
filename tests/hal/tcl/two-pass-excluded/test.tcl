# A .hal file with the magic comment is done once, before the others, and goes on after errors.
puts [catch {loadusr -w haltcl --twopass verbose late.hal ";" special.hal} m]
puts "functions: [hal list funct]"
puts "signals: [hal list sig]"
