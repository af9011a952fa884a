component comment;
pin in float a; /* no end
function _;
license "GPL";
;;
FUNCTION(_) { }
