component hashes;
pin in bit a-#;
function _;
license "GPL";
;;
FUNCTION(_) { }
