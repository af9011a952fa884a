component condition;
pin in float a if ;
function _;
license "GPL";
;;
FUNCTION(_) { }
