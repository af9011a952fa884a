component vars;
pin out float sum;
pin out s32 chars;
pin out bit each-# [2];
pin in s32 in = 5;
variable double w[3] = 1.5;
variable int n = 7;
variable int *where;
variable unsigned bits = 0x10;
variable hal_float_t f = 2.5;
function _;
license "GPL";
;;
FUNCTION(_) {
    int i;
    double s = 0;
    where = &n;
    for (i = 0; i < 3; i++) s += w[i];
    sum = s + *where + bits + f + in;
    chars = *where;
}
