component shown "A page to look at";
pin in bit in;
function _;
license "GPL";
;;
(void)period;
