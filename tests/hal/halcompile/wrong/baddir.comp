component baddir;
pin inn float a;
function _;
license "GPL";
;;
FUNCTION(_) { }
