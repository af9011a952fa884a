component all_params "module parameters of all kinds";
pin out s32 n;
function _;
license "GPL";
option extra_setup;
;;
static int a[4] = {1, 2, 3, 4};
RTAPI_MP_ARRAY_INT(a, 4, "numbers");
static char *names_of[3] = {0,};
RTAPI_MP_ARRAY_STRING(names_of, 3, "texts");
static char *one = "x";
RTAPI_MP_STRING(one, "a text");
static long big = 5;
RTAPI_MP_LONG(big, "long");
static int total;
EXTRA_SETUP() { int i; total = 0; for (i = 0; i < 4; i++) total += a[i]; for (i = 0; i < 3; i++) if (names_of[i]) total += 100 * strlen(names_of[i]); total += 1000 * one[0]; total += (int)big * 1000000; return 0; }
FUNCTION(_) { n = total; }
