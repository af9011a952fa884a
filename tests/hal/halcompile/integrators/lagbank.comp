component lagbank "A bank of first-order lags, one for each bit of personality";
pin in float in_##[16 : personality & 0x1f] = 0.5 "Input";
pin out float out-##[16 : personality & 0x1f];
pin out bit settled-##[16:personality&0x1f];
pin in bit hold if personality & 0x100 "Freeze";
pin out s32 count.total if (personality >> 9) & 1;
param rw float tau-## [16 : personality & 0x1f] = 0.02;
param r u32 worst = 0xff;
variable double state[16];
variable int calls = 0;
option default_count 2;
function update fp "Filter";
function reset nofp;
license "GPL";
author "An Integrator";
;;
FUNCTION(update) {
  int i, n = personality & 0x1f;
  if ((personality & 0x100) && hold) return;
  for (i = 0; i < n; i++) {
    double k = fperiod / (tau(i) + fperiod);
    state[i] += (in(i) - state[i]) * k;
    out(i) = state[i];
    settled(i) = state[i] > 0.49;
  }
  if ((personality >> 9) & 1) { if (calls < 20) calls++; count_total = calls; }
}
FUNCTION(reset) { int i; for (i = 0; i < 16; i++) state[i] = 0; worst = 0; }
