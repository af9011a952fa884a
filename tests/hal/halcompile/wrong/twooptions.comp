component twooptions;
pin in bit a;
option singleton yes;
function _;
option singleton no;
license "GPL";
;;
FUNCTION(_) { }
