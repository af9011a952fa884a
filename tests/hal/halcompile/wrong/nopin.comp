component nopin;
param rw s32 a;
function _;
license "GPL";
;;
FUNCTION(_) { }
