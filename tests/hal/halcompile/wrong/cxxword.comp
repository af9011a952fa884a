component cxxword;
option cxx;
pin in bit and;
function _;
license "GPL";
;;
FUNCTION(_) { }
