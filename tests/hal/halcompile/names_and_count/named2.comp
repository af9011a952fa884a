component named2;
pin in bit a;
function _;
license "GPL";
;;
FUNCTION(_) { }
