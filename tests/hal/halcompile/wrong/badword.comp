component badword;
pin in float a;
functoin _;
license "GPL";
;;
FUNCTION(_) { }
