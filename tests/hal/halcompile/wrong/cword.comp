component cword;
pin in float double;
function _;
license "GPL";
;;
FUNCTION(_) { }
