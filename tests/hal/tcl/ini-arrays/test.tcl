# [SECTION]KEY is $::SECTION(KEY), a list of all values of the key.
foreach section {EMC HAL JOINT_0 EMPTY X_YZ} {
  if {![array exists ::$section]} {
    puts "no array $section"
    continue
  }
  foreach key [lsort [array names ::$section]] {
    set values [set ::${section}($key)]
    puts "$section $key: [llength $values] <$values> first <[lindex $values 0]>"
  }
}
puts [expr {$::JOINT_0(MAX_VELOCITY) * 2}]
proc inside {} {
  return $::JOINT_0(MAX_VELOCITY)
}
puts [inside]
puts [catch {set ::JOINT_0(NOSUCH)} m]:$m
puts [catch {set ::JOINT_1(X)} m]:$m
# A second file adds its values.
parse_ini other.ini
puts "$::MORE(A) $::JOINT_0(MAX_VELOCITY) $::JOINT_0(TYPE)"
puts [catch {parse_ini nosuch.ini} m]:$m
puts [catch {parse_ini} m]:$m
# Values go to HAL, also from files in halcmd's language.
newsig vel float
sets vel "[lindex $::JOINT_0(MAX_VELOCITY) 0] * 0.5"
source level.hal
puts "[hal gets vel] [hal gets level]"
puts [catch {source wrong.hal} m]:$m
