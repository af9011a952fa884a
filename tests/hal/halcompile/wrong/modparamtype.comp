component modparamtype;
pin in bit a;
modparam string x;
function _;
license "GPL";
;;
FUNCTION(_) { }
