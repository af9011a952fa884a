component io_mux "dash in the name";
pin in bit sel.0;
pin in bit sel.1;
pin in s32 data-##[8];
pin out s32 out-#[2 : (personality & 3)] if personality;
pin out u32 n_used;
function read_all nofp;
function write_all nofp;
license "GPL";
;;
FUNCTION(read_all) { n_used = sel_0 + 2*sel_1; }
FUNCTION(write_all) { int i; for (i = 0; i < (personality & 3); i++) out(i) = data(i + n_used); }
