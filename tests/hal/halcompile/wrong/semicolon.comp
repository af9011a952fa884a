component semicolon;
pin in float a
pin in float b;
function _;
license "GPL";
;;
FUNCTION(_) { }
