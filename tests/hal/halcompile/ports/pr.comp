component pr;
pin in port rx;
pin out s32 sum;
function _;
license "GPL";
;;
FUNCTION(_) {
    char c[4];
    if (hal_port_readable(rx_ptr) < 4 || !hal_port_read(rx_ptr, c, 4)) return;
    sum = c[0] + c[1] + c[2] + c[3];
}
