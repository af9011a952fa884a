# Programs that scripts start: their status counts, their output comes in order, and they find this HAL.
puts first
loadusr -w echo second
puts third
puts [catch {loadusr -w false} m]:$m
puts [loadusr -w -i false]
puts [catch {loadusr -w nosuchprogram} m]:$m
newsig s s32
loadusr -w halcmd sets s 42
puts [hal gets s]
# The package, in Debian's tclsh.
loadusr -w tclsh package.tcl
puts [hal gets s]
