component one_reader """Triple
quoted
doc""";
option singleton yes;
option extra_setup yes;
option extra_cleanup yes;
pin out u32 n = 7;
param r u32 ver = 0x10;
function read "reads";
function write nofp;
license "GPL";
;;
static int count;
EXTRA_SETUP() { count = 41; ver = 99; return 0; }
EXTRA_CLEANUP() { count = 0; }
FUNCTION(read) { n = ++count; }
FUNCTION(write) { (void)period; }
