component optionvalue;
pin in float a;
option singleton maybe;
function _;
license "GPL";
;;
FUNCTION(_) { }
