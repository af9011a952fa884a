component boards_of "personality in sizes";
pin in bit in-##[8 : personality & 0xf];
pin in float scale if personality & 0x100;
pin out s32 total if (personality >> 9) & 1;
param rw float w-#[4 : (personality & 0xf) / 4] = 2.5 if personality & 0x100 "weights";
variable int last[16] = 1;
variable double acc = 3.5;
function _;
option default_personality 0x104;
license "GPL";
;;
FUNCTION(_) { int i, n = 0; for(i=0;i<(personality & 0xf);i++) if(in(i)) n++;
 if ((personality >> 9)&1) total = n + last[0]; acc += 1; }
