component terminals "A bus coupler: what stands behind it is known when it is loaded";
description """
Each instance reads its row of terminals= and makes a pin for each letter: i an input, o an output. What else it has is declared here.""";
pin out u32 count_ "Terminals";
pin out u32 inputs;
param r s32 address "From base= and the number of the instance";
variable hal_bit_t **bits;
variable char kinds[17];
variable unsigned all;
option extra_setup;
option extra_cleanup;
function read "Inputs into inputs";
function write_ "Outputs from inputs, the other way round";
include <rtapi_string.h>;
license "GPL";
author "One";
author "Two";
;;
static char *terminals[4] = {"io", "", "", ""};
RTAPI_MP_ARRAY_STRING(terminals, 4, "kinds of the terminals of each instance");
static char *title = "bus";
RTAPI_MP_STRING(title, "middle part of the names of terminals");
static int base = 0x10;
RTAPI_MP_INT(base, "address of the first instance");

EXTRA_SETUP() {
    int i, n = strlen(terminals[extra_arg]);
    if (n > 16) {
        rtapi_print_msg(RTAPI_MSG_ERR, "%s: %d terminals, at most 16\n", prefix, n);
        return -EINVAL;
    }
    strcpy(kinds, terminals[extra_arg]);
    bits = hal_malloc((n + 1) * sizeof *bits);
    if (!bits) return -ENOMEM;
    for (i = 0; i < n; i++) {
        int r = hal_pin_bit_newf(kinds[i] == 'o' ? HAL_OUT : HAL_IN, &bits[i], comp_id, "%s.%s.%s-%02d", prefix, title, kinds[i] == 'o' ? "out" : "in", i);
        if (r) return r;
    }
    all = n;
    address = base + extra_arg;
    return 0;
}
static int closed;
EXTRA_CLEANUP() { closed = 1; }
static unsigned word(struct __comp_state *__comp_inst) {
    unsigned i, out = 0;
    for (i = 0; i < all; i++) if (kinds[i] == 'i' && *bits[i]) out |= 1u << i;
    return out;
}
FUNCTION(read) { count_ = all; inputs = word(__comp_inst); }
FUNCTION(write_) {
    unsigned i, at = 0;
    for (i = 0; i < all; i++) if (kinds[i] == 'o') *bits[i] = !(inputs >> at++ & 1);
}
