component noper;
option period no;
pin out s32 n;
pin out s32 m;
function first;
function second;
license "GPL";
;;
FUNCTION(first) { n = 11; }
FUNCTION(second) { m = n + 1; }
