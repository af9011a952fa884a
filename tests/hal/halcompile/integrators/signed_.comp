component signed_ "Old and new words for the same";
pin in signed in; pin out unsigned out_; pin out s32 wide if 1; pin in u32 uw = 123;
param rw signed k = 3; param rw unsigned j_ = 5;
function _;
license "GPL";
;;
FUNCTION(_) { out_ = in * k + j_; wide = uw; }
