// comments of both kinds
component oldstyle/*odd*/"old";
pin in signed i; pin in unsigned u; pin out float f=1e-3"doc";
function _ fp;
license "GPL";
;;
FUNCTION(_) { f = i + u; }
