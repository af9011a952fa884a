component gates2 "Experimental logic";
pin in bit in-##[16 : personality & 0xff];
pin out bit and if personality & 0x100;
pin out bit or if personality & 0x200;
pin out bit xor if personality & 0x400;
param rw s32 weight-# [4 : (personality >> 12) & 3] if (personality & 0x3000) != 0 = 2 "weights";
pin out s32 n = 9 "number";
function _ nofp;
license "GPL";
;;
FUNCTION(_) {
    int i, a=1, o=0, x=0;
    for(i=0; i < (personality & 0xff); i++) {
        if(in(i)) { o = 1; x = !x; }
        else { a = 0; }
    }
    if(personality & 0x100) and = a;
    if(personality & 0x200) or = o;
    if(personality & 0x400) xor = x;
    n = 0;
    for (i = 0; i < ((personality >> 12) & 3); i++) n += weight(i);
}
