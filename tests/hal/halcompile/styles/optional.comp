component optional "if without array, code guards by personality";
pin in bit a;
pin in bit b if personality & 1;
pin out bit q = 1 if personality & 2;
param rw s32 t-#[3 : personality] if personality > 1;
param r float u if (personality == 3);
function _;
license "GPL";
;;
FUNCTION(_) { if (personality & 2) q = a; if (personality & 1) { int x = b; (void)x; } }
