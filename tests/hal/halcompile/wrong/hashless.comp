component hashless;
pin in bit a [4];
function _;
license "GPL";
;;
FUNCTION(_) { }
