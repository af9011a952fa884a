component quoted """Long
description with "quotes" and \\backslash""";
description r"""
Raw \fBtext\fR
""";
examples """loadrt quoted""";
pin in s32 in "First" ;
pin out s32 out "Second" ;  // a comment
/* another
   comment */
param rw s32 off=+7 "Offset";
function _ "Does it";
author "A"; 
license "GPL";
;;
FUNCTION(_) { out = in + off; }
