component twice;
pin in bit a;
pin out bit a;
function _;
license "GPL";
;;
FUNCTION(_) { }
