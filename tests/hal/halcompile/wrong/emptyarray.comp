component emptyarray;
pin in float a-#[0];
function _;
license "GPL";
;;
FUNCTION(_) { }
