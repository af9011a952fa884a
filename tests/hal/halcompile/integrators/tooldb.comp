component tooldb "modparam, include, helper functions that take the instance";
include <rtapi_string.h>;
include <rtapi_math.h>;
pin in u32 tool;
pin out float length;
pin io bit request = 1;
pin out bit found = FALSE;
modparam int slots = 4 "How many";
modparam dummy note """A parameter for the page
alone.""";
variable float table[8];
variable int name_length = 6;
variable int ticks = 0;
function lookup fp;
license "GPL";
;;
#define HALF(x) ((x) * 0.5)
static float get(struct __comp_state *__comp_inst, int i) {
  table[i] = HALF(i);
  return table[i];
}
FUNCTION(lookup) {
  ticks += period > 0;
  if (!request) return;
  found = (int)tool < slots && name_length == 6;
  length = found ? get(__comp_inst, tool) + fabs(sin(0.0)) : -1.0;
  request = 0;
}
