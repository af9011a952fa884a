component named "names=";
pin out s32 x;
function f;
license "GPL";
;;
FUNCTION(f) { x++; }
