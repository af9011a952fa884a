component badtype;
pin in flaot a;
function _;
license "GPL";
;;
FUNCTION(_) { }
