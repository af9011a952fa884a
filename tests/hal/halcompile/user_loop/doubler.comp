component doubler "A program";
option userspace;
pin in float in = 3;
pin out float out;
pin out bit flag-# [2];
param rw float gain = 2;
license "GPL";
;;
#include <unistd.h>
void user_mainloop(void) {
    while (1) {
        usleep(1000);
        FOR_ALL_INSTS() { out = in * gain; flag(1) = 1; }
    }
}
