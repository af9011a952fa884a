halcompile --document --keep-adoc=kept.adoc paged.comp 2>/dev/null
cat paged.9
halcompile --adoc paged.comp 2>/dev/null
cat paged.9.adoc
cmp kept.adoc paged.9.adoc
KERF_MAN=$PWD/man halcompile --install-doc paged.comp 2>/dev/null
cmp man/man9/paged.9 paged.9
groff -man -Tutf8 -ww -z paged.9 && echo groff has nothing to say
