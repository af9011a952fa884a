component own_app "rtapi_app no";
pin in s32 in;
pin out s32 out;
option rtapi_app no;
option extra_setup no;
function double_it nofp;
license "GPL";
;;
#include "rtapi_app.h"
FUNCTION(double_it) { out = in * 2; }
int rtapi_app_main(void) {
  int r;
  comp_id = hal_init("own_app");
  if (comp_id < 0) return comp_id;
  r = export("own-app.left", 0);
  if (r) { hal_exit(comp_id); return r; }
  r = export("own-app.right", 1);
  if (r) { hal_exit(comp_id); return r; }
  hal_ready(comp_id);
  return 0;
}
void rtapi_app_exit(void) { hal_exit(comp_id); }
