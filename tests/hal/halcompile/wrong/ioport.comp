component ioport;
pin io port a;
function _;
license "GPL";
;;
FUNCTION(_) { }
