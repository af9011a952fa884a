component only_one;
pin out s32 n;
param rw s32 step = 3;
function count_up;
option singleton yes;
license "GPL";
;;
FUNCTION(count_up) { n = step * 2; }
