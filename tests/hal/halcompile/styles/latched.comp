component latched "io pins and params r";
pin io bit latch;
pin io s32 count_ = 5;
param r s32 seen;
function _;
license "GPL";
;;
FUNCTION(_) { if (latch) { latch = 0; count_++; } seen = count_; }
