component arrvar;
pin in bit clk;
pin in float sample;
pin out float mean;
pin out s32 n;
param rw u32 window = 8;
variable float hist[64];
variable unsigned last = 0;
variable unsigned pos = 0x0;
variable hal_float_t sum;
function _ fp;
license "GPL"; // GPLv2 or higher
author "me";
;;
FUNCTION(_) {
  unsigned i; float s = 0;
  if (clk && !last) { hist[pos % 64] = sample; pos++; }
  last = clk;
  for (i = 0; i < window && i < pos; i++) s += hist[(pos - 1 - i) % 64];
  mean = i ? s / i : 0; n = pos;
  sum = mean;
}
