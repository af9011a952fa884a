component nodefault;
pin in bit a; pin in bit b; pin out bit y = true;
pin out s32 n = -5; pin io u32 mask = 0x0F;
param rw bit invert = 0;
param r float last = 1e-3;
option singleton yes;
option data dd;
function _ nofp;
see_also "\\fBand2\\fR(9)";
notes """Two
lines.""";
license "GPL-2.0-or-later";
;;
typedef struct { int runs; } dd;
FUNCTION(_) {
  dd *d = &data;
  d->runs++;
  y = (a && b) != invert;
  n = d->runs > 0;
  mask |= 0x10;
  last = 2.5;
}
