component again;
pin in s32 in;
pin out s32 out;
function _;
license "GPL";
;;
out = in + 1;
