puts "package Hal [package require Hal]"
puts "[hal gets s] [catch {hal gets nosuch} m] $m"
sets s 6*7+1
