component example;
pin in s32 in;
pin out bit out1;
pin out bit out2;
function _;
license "GPL";
;;
// general pin set true function
void set(hal_bit_t *p){
    *p = 1;
}
// general pin set false function
void unset(hal_bit_t *p){
    *p = 0;
}
FUNCTION(_) {
    if (in < 0){
        set(&out1);
        unset(&out2);
    }else if (in >0){
        unset(&out1);
        set(&out2);
    }else{
        unset(&out1);
        unset(&out2);
    }
}
