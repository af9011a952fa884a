component upers;
option userspace;
modparam int start = 5 "first number";
pin out s32 n-# [4 : personality];
pin out bit more if personality > 2;
license "GPL";
;;
#include <unistd.h>
void user_mainloop(void) {
    while (1) {
        FOR_ALL_INSTS() { int i; for (i = 0; i < personality; i++) n(i) = start + i; }
        usleep(1000);
    }
}
