component code_bits "a case statement with ranges, unions, bit fields, do while, ternaries";
pin in u32 code = 0x35;
pin out bit b-##[8];
pin out s32 kind;
function _;
license "GPL";
;;
typedef union { struct { unsigned lo:4, hi:4; } f; unsigned w; } un;
FUNCTION(_) {
  un u; u.w = code; int i = 0;
  switch (u.f.hi) { case 0 ... 2: kind = 0; break; case 3: kind = u.f.lo; break; default: kind = -1; }
  do { b(i) = (code >> i) & 1; } while (++i < 8);
}
