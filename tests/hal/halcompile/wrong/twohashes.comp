component twohashes;
pin in bit a-#-b# [4];
function _;
license "GPL";
;;
FUNCTION(_) { }
