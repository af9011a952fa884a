component reserved;
pin in bit comp_id;
function _;
license "GPL";
;;
FUNCTION(_) { }
