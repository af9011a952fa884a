component other;
pin in bit a;
license "GPL";
;;
