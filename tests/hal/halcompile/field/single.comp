component single "one only";
option singleton yes;
option extra_setup yes;
option extra_cleanup;
pin out s32 pid;
pin out u32 mask = 0xff;
function _;
license "GPL";
;;
static int started;
EXTRA_SETUP() { started = 1; (void)prefix; (void)extra_arg; return 0; }
EXTRA_CLEANUP() { started = 0; }
FUNCTION(_) { pid = 42; if (started) mask |= 0x100; }
