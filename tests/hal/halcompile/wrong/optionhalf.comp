component optionhalf;
pin in bit a;
option default_count 1.5;
function _;
license "GPL";
;;
FUNCTION(_) { }
