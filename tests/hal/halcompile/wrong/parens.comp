component parens;
pin in float a if (personality & 1;
function _;
license "GPL";
;;
FUNCTION(_) { }
