component noend;
pin in float a;
function _;
license "GPL";
