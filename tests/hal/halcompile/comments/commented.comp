component/**/commented/*x*/"doc" ;pin in bit a;pin out bit b // why
= 1 ; /* ; */ function _ ; license "GPL";
;;
b = a;
