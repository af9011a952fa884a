component after;
option post_export;
pin out s32 n;
function _;
license "GPL";
;;
static int refuse = 0;
RTAPI_MP_INT(refuse, "1: refuse");
POST_EXPORT() { n = 100 + extra_arg; return refuse ? -EPERM : 0; }
FUNCTION(_) { }
