component pers_if;
pin in float x;
pin in float y if (personality & 1);
pin out float z if personality > 1;
pin out bit b-#[3 : personality & 3] if personality & 2;
param rw s32 k = 7 if personality & 1;
option default_personality 3;
function calc;
license "GPL";
;;
FUNCTION(calc) { }
