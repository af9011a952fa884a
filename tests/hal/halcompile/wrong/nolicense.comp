component nolicense;
pin in bit a;
function _;
;;
FUNCTION(_) { }
