component three;
pin in bit a;
option default_count 3;
function _;
license "GPL";
;;
FUNCTION(_) { }
