component setupless;
pin in bit a;
option extra_setup;
function _;
license "GPL";
;;
FUNCTION(_) { }
