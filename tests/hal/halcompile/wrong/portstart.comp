component portstart;
pin in port a = 1;
function _;
license "GPL";
;;
FUNCTION(_) { }
