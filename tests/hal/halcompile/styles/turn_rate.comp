component turn_rate "fperiod in the function, static inline helpers, mixed declarations";
pin in float in-deg = 90;
pin out float rad;
pin out float rate;
variable double old;
variable _Bool first = 1;
function _ fp;
license "GPL";
;;
#include <rtapi_math.h>
static inline double to_rad(double d) { return d * (M_PI / 180.0); }
static const char *const texts[] __attribute__((unused)) = { "a", "b" };
typedef struct __attribute__((packed)) { unsigned char a; unsigned short b; } pk;
FUNCTION(_) {
  // C99
  for (int i = 0; i < 2; i++) { double q = to_rad(in_deg); rad = q; }
  rate = first ? 0 : (rad - old) / fperiod;
  old = rad; first = 0;
  long p = period; (void)p; (void)sizeof(pk);
}
