component tables "defines and static functions";
pin in s32 sel;
pin out float y-##[3];
variable char name[32];
variable double *table;
function update;
option extra_setup;
license "GPL";
author "A"; 
;;
#include <math.h>
#define SQ(x) ((x)*(x))
#ifndef TRUE
#error TRUE
#endif
static const double k[] = {1.0, 2.0, 3.0};
static double poly(double x);
EXTRA_SETUP() {
  table = hal_malloc(3 * sizeof(double));
  if (!table) return -1;
  rtapi_snprintf(name, sizeof(name), "%s", prefix);
  table[0] = 1; table[1] = SQ(2); table[2] = poly(3);
  return extra_arg >= 0 ? 0 : -22;
}
static double poly(double x) { return k[0] + k[1] * x + k[2] * x * x; }
FUNCTION(update) { int i; for (i = 0; i < 3; i++) y(i) = table[i] + sqrt(4.0) + name[0]; }
