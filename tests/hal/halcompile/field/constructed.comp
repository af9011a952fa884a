component constructed;
option constructable yes;
pin in float in;
pin out float out;
function _;
license "GPL";
;;
FUNCTION(_) { out = -in; }
