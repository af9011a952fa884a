component shares "Static data, EXTRA_SETUP and EXTRA_CLEANUP";
pin in float demand;
pin out float share;
pin out u32 instances;
option extra_setup yes;
option extra_cleanup;
option default_count 3;
function _ fp;
license "GPL";
;;
static int made = 0;
EXTRA_SETUP() {
  (void)prefix; (void)extra_arg;
  made++;
  return 0;
}
EXTRA_CLEANUP() { rtapi_print_msg(RTAPI_MSG_DBG, "shares: %d gone\n", made); made = 0; }
static double total(void) {
  double sum = 0;
  struct __comp_state *__comp_inst;
  for (__comp_inst = __comp_first_inst; __comp_inst; __comp_inst = __comp_inst->_next) sum += demand;
  return sum;
}
FUNCTION(_) {
  double sum = total();
  share = sum > 0 ? demand / sum : 0;
  instances = made;
}
