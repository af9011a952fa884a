component wide;
pin in s64 a = -5000000000;
pin in u64 b = 0xffffffffffff;
pin out s64 sum;
pin out u64 product;
pin out s64 each-# [2] = 3;
param rw s64 p = 1;
param r u64 q;
function _;
license "GPL";
;;
FUNCTION(_) { sum = a + p; product = b * 2; q = b; each(1) = a / 2; }
