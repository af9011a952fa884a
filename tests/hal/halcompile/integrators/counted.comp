component counted "count_function with a module string";
pin out s32 index;
pin in bit enable = 1;
option count_function yes;
option extra_setup;
variable int mine;
function _;
license "GPL";
;;
static int next = 0;
static char *cfg = "abc";
RTAPI_MP_STRING(cfg, "letters");
static int get_count(void) { int n = 0; while (cfg[n]) n++; return n; }
EXTRA_SETUP() { mine = next++; return 0; }
FUNCTION(_) { index = enable ? mine : -1; }
