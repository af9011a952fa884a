component alltypes;
pin in bit b_in = 1;
pin in float f_in = -1.25e-3;
pin in s32 s_in = -7;
pin in u32 u_in = 0xfffffff0;
pin in signed sg_in = 12;
pin in unsigned un_in = 34;
pin out bit b_out;
pin out float f_out;
pin out signed s_out;
pin out unsigned u_out;
pin io bit b_io = TRUE;
pin io float f_io = .5;
pin io s32 s_io = +3;
pin io u32 u_io = 3;
param r bit b_r = TRUE;
param r float f_r = 3;
param r s32 s_r = -3;
param r u32 u_r = 4000000000;
param rw bit b_rw = FALSE;
param rw float f_rw = 1e10;
param rw signed s_rw = 0;
param rw unsigned u_rw = 1;
function _;
license "GPL";
;;
FUNCTION(_) {
    b_out = !b_in; f_out = f_in * 2 + f_rw; s_out = s_in + sg_in; u_out = u_in + un_in;
    if (b_io) { b_io = 0; f_io += 1; s_io = s_io - 1; u_io <<= 2; }
    b_r = b_rw; f_r = f_rw; s_r = s_rw - 1; u_r = u_rw + 1;
}
