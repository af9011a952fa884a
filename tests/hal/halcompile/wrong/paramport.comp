component paramport;
pin in float a;
param rw port p;
function _;
license "GPL";
;;
FUNCTION(_) { }
