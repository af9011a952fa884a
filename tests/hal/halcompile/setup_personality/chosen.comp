component chosen "EXTRA_SETUP chooses how many";
option extra_setup;
pin in bit in-#[8 : personality];
pin out s32 n;
function _;
license "GPL";
;;
static int sizes[4] = {1, 2, 3, 4};
RTAPI_MP_ARRAY_INT(sizes, 4, "inputs of each");
EXTRA_SETUP() { personality = sizes[extra_arg]; return 0; }
FUNCTION(_) { int i; n = 0; for (i = 0; i < personality; i++) n += in(i); }
