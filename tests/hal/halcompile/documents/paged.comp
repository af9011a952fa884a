component paged """All that a page may have
The second line of the component's own text belongs to the description.""";
/* a comment
   of two lines */ pin in bit in-##[4] if personality & 1 "Inputs, *bold* and _italic_";
pin out float out = 2.5 r"With \fBgroff\fR marks";   // at the end
pin io s32 index_enable;
param rw float max_ = 1e3 "The \"most\" \\fIevery\\fR cycle";
param r u32 count-# [2 : personality] """Two
lines.""";
modparam int depth = 7 "Depth of all";
modparam dummy rate "Documentation only";
variable int x[3] = 1;
option default_count 2;
option extra_compile_args "-O3";
function _ nofp "Does it all";
function other_one;
description """
One paragraph.

* first
* second

Another, with `code` and a minus -1.

----
net a => b
----
""";
description r"""
.TP
term
groff text with \fIitalic\fR words
""";
examples "loadrt paged\n.br\naddf paged.0 servo-thread";
notes "None.";
see_also "\\fBand2\\fR(9)";
author "A";
author "B and C";
license "GPL v2";
license "or MIT";
;;
FUNCTION(_) { }
FUNCTION(other_one) { out = x[1] + index_enable; }
