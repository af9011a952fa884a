# Words are found from everywhere, and a script may make its own of the same name.
namespace eval mine {
  newsig inside bit
  proc net {args} {puts "my net $args"}
  net a b
  puts [catch {::net outside b.nothing}]
}
