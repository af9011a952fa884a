component undefined;
pin in float a;
function f;
function g;
license "GPL";
;;
FUNCTION(f) { }
