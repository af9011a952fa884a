component twofunctions;
pin in float a;
function f;
function g;
license "GPL";
;;
a;
