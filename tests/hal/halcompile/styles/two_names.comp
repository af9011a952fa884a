component two_names "no rtapi_app";
option rtapi_app no;
pin out s32 x;
pin in bit en-#[2];
function _;
license "GPL";
;;
#include <rtapi_string.h>
static char *cfg = "one";
RTAPI_MP_STRING(cfg, "name");
int rtapi_app_main(void) {
  int r;
  comp_id = hal_init("two_names");
  if (comp_id < 0) return comp_id;
  r = export("seven", 0);
  if (r == 0) r = export("eight.x", 1);
  if (r) { hal_exit(comp_id); return r; }
  hal_ready(comp_id);
  return 0;
}
void rtapi_app_exit(void) { hal_exit(comp_id); }
FUNCTION(_) { x = en(0) + 2 * en(1); }
