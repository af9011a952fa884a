component inc;
include <rtapi_math.h>;
include "table.h";
pin out float out;
variable struct_of_mine own;
function _;
license "GPL";
;;
FUNCTION(_) { own.b = TABLE_SIZE; out = sqrt(own.b) + table[3]; }
