component userfunction;
pin in float a;
option userspace;
function f;
license "GPL";
;;
void user_mainloop(void) { }
