component spelt "Options with all values that say yes or no";
option singleton 0;
option extra_setup TRUE;
option extra_cleanup true;
option post_export 1;
option count_function FALSE;
option constructable false;
option period yes;
option userspace no;
option rtapi_app true;
option default_count 2;
pin out s32 n;
variable int first;
function _;
license "GPL";
;;
EXTRA_SETUP() { first = (int)(extra_arg + 40); return 0; }
POST_EXPORT() { n = first; rtapi_print_msg(RTAPI_MSG_ERR, "%s is there\n", prefix); return 0; }
EXTRA_CLEANUP() { rtapi_print_msg(RTAPI_MSG_ERR, "all are gone\n"); }
FUNCTION(_) { n = n + 2; }
