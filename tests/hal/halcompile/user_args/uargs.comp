component uargs;
option userspace yes;
option userinit yes;
option extra_cleanup;
option extra_link_args "-lm";
option extra_compile_args "-DFACTOR=3 -O1";
pin out s32 words;
pin out float root;
variable int seen = 4;
license "GPL";
;;
#include <math.h>
#include <unistd.h>
#include <string.h>
static int n;
void userinit(int argc, char **argv) { int i; for (i = 1; i < argc; i++) if (!strncmp(argv[i], "word", 4)) n++; }
EXTRA_CLEANUP() { }
void user_mainloop(void) {
    while (1) {
        FOR_ALL_INSTS() { words = n * FACTOR; root = sqrt((double)seen); }
        usleep(1000);
    }
}
