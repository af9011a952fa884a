component pair "Two functions on one state";
pin out s32 reads;
pin out s32 age;
pin in s32 limit = 1000;
variable int n;
function read fp "Reads";
function write nofp "Writes";
license "GPL";
;;
FUNCTION(read) { if (n < limit) n++; reads = n; }
FUNCTION(write) { age = limit - n; }
