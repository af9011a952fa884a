component string;
pin in float a "no end;
pin in float b;
function _;
license "GPL";
;;
FUNCTION(_) { }
