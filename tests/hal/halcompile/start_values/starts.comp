component starts;
pin out u32 hex = 0x1F;
pin out u32 bin = 0b101;
pin out u32 oct = 0o17;
pin out float expo = -2.5e-3;
pin out float named = M_PI;
pin out bit yes_ = yes;
pin out bit true_ = true;
param rw s32 minus = -12;
function _;
license "GPL";
include <rtapi_math.h>;
;;
FUNCTION(_) { }
