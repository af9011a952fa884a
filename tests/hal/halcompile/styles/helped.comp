component helped "passes the instance to a helper";
pin in float x;
pin out float y;
param rw float k = 2;
function _;
license "GPL";
;;
static double help(struct __comp_state *__comp_inst, double more) { return x * k + more; }
FUNCTION(_) { y = help(__comp_inst, 1.0); }
