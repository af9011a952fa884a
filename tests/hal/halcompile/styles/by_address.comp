component by_address "addresses of out pins";
pin out float y-#[3];
pin out s32 n;
param rw float k = 1;
function _;
license "GPL";
;;
static void put(volatile hal_float_t *p, double v) { *p = v; }
FUNCTION(_) { put(&y(1), k + 4); hal_s32_t volatile *q = &n; *q += 2; }
