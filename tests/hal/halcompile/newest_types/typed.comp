component typed "Pins of the newest kind";
pin in bool on = true "in";
pin in real x = 2.5;
pin in si32 i = -4;
pin in ui32 u = 9;
pin in sint l = -5000000000;
pin in uint k = 0xffffffffff;
pin out bool on_out;
pin out real x_out = 1;
pin out sint l_out;
pin out uint k_out;
pin out si32 each-##[3] = 7;
pin io ui32 shared_;
param rw real gain = 2;
param r bool seen;
param rw si32 offset-# [2] = 10;
function _;
license "GPL";
;;
static void add(hal_real_t where, double v) { hal_set_real(where, hal_get_real(where) + v); }
FUNCTION(_) {
    on_out_set(!on);
    if (!seen) add(x_out_ptr, x * gain);
    l_out_set(l + i);
    k_out_set(k + u);
    each_set(1, each(0) + offset(1));
    shared__set(each(2));
    offset_set(0, -1);
    seen_set(1);
}
