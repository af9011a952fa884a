component twolicenses;
pin in bit a;
function _;
license "MIT";
license "GPL";
;;
FUNCTION(_) { }
