component ownapp;
option rtapi_app no;
pin out s32 n;
function _;
license "GPL";
;;
static int count = 2;
RTAPI_MP_INT(count, "how many");
FUNCTION(_) { if (n < 3) n++; }
int rtapi_app_main(void) {
  int i;
  comp_id = hal_init("ownapp");
  if (comp_id < 0) return comp_id;
  for (i = 0; i < count; i++) {
    char buf[HAL_NAME_LEN + 1];
    int r;
    rtapi_snprintf(buf, sizeof buf, "own-%c", 'a' + i);
    r = export(buf, i);
    if (r != 0) { hal_exit(comp_id); return r; }
  }
  hal_ready(comp_id);
  return 0;
}
void rtapi_app_exit(void) { hal_exit(comp_id); }
