component halnames "What becomes of names";
pin in bit x_y_z;
pin in bit a-b.c;
pin out bit min_;
pin in s32 m.##.n [3];
pin in s32 m2.## [2];
pin in s32 k-###-x_y [2];
pin in u32 v_# [12];
param rw float gain_one = 1.5;
param r unsigned two__under;
function read_all;
function write_;
license "GPL";
;;
FUNCTION(read_all) { min_ = x_y_z && a_b_c; }
FUNCTION(write_) { two_under = m_n(2) + m2(1) + k_x_y(0) + v(11) + (int)gain_one; }
