component early_pin "Writes a pin where there is none yet";
option extra_setup;
pin out s32 n;
function _;
license "GPL";
;;
EXTRA_SETUP() { n = 1; return 0; }
FUNCTION(_) { }
