component tuned;
modparam int gain = 3 "Gain of all";
modparam int plain "Without a start";
pin in s32 in;
pin out s32 out;
function _;
license "GPL";
;;
FUNCTION(_) { out = in * gain + plain; }
