component usermain;
pin in float a;
option userspace;
license "GPL";
;;
