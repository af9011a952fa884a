component star;
pin in float a;
variable int* x;
function _;
license "GPL";
;;
FUNCTION(_) { }
