component few;
pin in bit in-#[4 : personality];
function _;
license "GPL";
;;
FUNCTION(_) { }
