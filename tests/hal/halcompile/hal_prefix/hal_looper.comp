component hal_looper;
pin out float example = 4.25;
function _;
license "GPL";
;;
FUNCTION(_) { }
