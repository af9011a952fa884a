component pw;
pin out port tx;
pin in bit go;
variable int said;
function _;
license "GPL";
;;
FUNCTION(_) { if (go && !said) said = hal_port_write(tx_ptr, "kerf", 4); }
