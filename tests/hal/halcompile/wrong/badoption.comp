component badoption;
pin in float a;
option singelton yes;
function _;
license "GPL";
;;
FUNCTION(_) { }
