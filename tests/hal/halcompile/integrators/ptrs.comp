component ptrs "Pointers to items, C99, static inline, arrays without personality";
pin in bit sw-#[4]; pin out s32 code; pin out bit any;
pin out float table-##[12] = 1.5;
param r s32 hist-#[3] = -1;
function scan fp;
function blink;
license "GPL";
;;
static inline int bits(struct __comp_state *__comp_inst) {
  int r = 0;
  for (int i = 0; i < 4; i++) if (sw(i)) r |= 1 << i;
  return r;
}
FUNCTION(scan) {
  const int c = bits(__comp_inst);
  code = c; any = c != 0;
  hist(2) = hist(1); hist(1) = hist(0); hist(0) = c;
  for (int i = 0; i < 12; i++) table(i) += 0.25;
}
FUNCTION(blink) { any = !any; }
