component boards "As many as there are addresses";
pin out unsigned out_ "Address";
param r unsigned ioaddr;
function _;
option count_function;
option extra_setup;
option extra_cleanup;
license "GPL";
;;
#define MAX 8
int io[MAX] = {0,};
RTAPI_MP_ARRAY_INT(io, MAX, "I/O addresses of boards");
int get_count(void) {
    int i = 0;
    for(i=0; i<MAX && io[i]; i++) { /* Nothing */ }
    return i;
}
EXTRA_SETUP() {
    if(io[extra_arg] == 666) { io[extra_arg] = 0; return -EBUSY; }
    ioaddr = io[extra_arg];
    return 0;
}
EXTRA_CLEANUP() {
    int i;
    for(i=0; i < MAX && io[i]; i++) rtapi_print_msg(RTAPI_MSG_ERR, "release %x\n", io[i]);
}
FUNCTION(_) { out_ = ioaddr; }
