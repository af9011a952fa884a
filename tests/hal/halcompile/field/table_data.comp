component table_data;
option data table_t;
option extra_link_args "-lm";
include <rtapi_math.h>;
pin in float in;
pin out float out;
param rw float knot-#[5];
variable int calls = 3;
function lookup;
license "LGPL";
;;
typedef struct { float v[5]; int n; } table_t;
FUNCTION(lookup) {
  data.n = 5;
  out = knot(data.n - 1) + sqrt(in) + (calls++ > 2 ? 1 : 0);
}
