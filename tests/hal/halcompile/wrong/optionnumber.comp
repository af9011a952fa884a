component optionnumber;
pin in float a;
option default_count many;
function _;
license "GPL";
;;
FUNCTION(_) { }
