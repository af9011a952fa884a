component named;
pin in bit a;
function _;
license "GPL";
;;
FUNCTION(_) { }
