component own_main;
pin out s32 n;
param rw s32 start;
function _;
option rtapi_app no;
license "GPL";
;;
static int boards = 2;
RTAPI_MP_INT(boards, "how many");
int rtapi_app_main(void) {
    int i, r = 0;
    comp_id = hal_init("own_main");
    if (comp_id < 0) return comp_id;
    for (i = 0; i < boards && r == 0; i++) {
        char name[HAL_NAME_LEN + 1];
        rtapi_snprintf(name, sizeof name, "board%c", 'a' + i);
        r = export(name, i);
    }
    if (r != 0) { hal_exit(comp_id); return r; }
    hal_ready(comp_id);
    return 0;
}
void rtapi_app_exit(void) { hal_exit(comp_id); }
FUNCTION(_) { n = start + 1; }
