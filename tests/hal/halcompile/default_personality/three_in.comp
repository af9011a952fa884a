component three_in;
option default_personality 3;
pin in bit in-#[8 : personality];
function _;
license "GPL";
;;
FUNCTION(_) { }
