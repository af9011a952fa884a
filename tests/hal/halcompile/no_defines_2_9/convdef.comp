component convdef "Members named as in LinuxCNC 2.9";
option no_convenience_defines;
pin in s32 in;
pin out s32 out;
pin out float arr-#[3];
param rw s32 gain = 2;
variable int count = 3;
function _;
license "GPL";
;;
/* FUNCTION() is not there: the functions are written out. */
static void _(struct __comp_state *__comp_inst, long period) {
  int i;
  (void)period;
  *__comp_inst->out = *__comp_inst->in * __comp_inst->gain + __comp_inst->count;
  for (i = 0; i < 3; i++) *(__comp_inst->arr[i]) = i * 0.5;
}
