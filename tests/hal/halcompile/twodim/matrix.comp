component matrix;
pin out float trace;
variable double m[3][4] = 2;
variable unsigned long counts = 3;
variable char *text = "four";
variable struct_less *none;
function _;
include "less.h";
license "GPL";
;;
FUNCTION(_) { m[0][0] = 1; trace = m[0][0] + m[1][1] + m[2][3] + counts + (none == 0) + (text[0] == 'f'); }
