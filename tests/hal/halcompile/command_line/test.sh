# The options that the other cases do without.
halcompile --help | sed -n 1,3p
halcompile --print-modinc | sed 's/.*share/share/'
test -r "$(halcompile --print-modinc)" && echo the fragment is there
halcompile --print-flags | tr ' ' '\n' | grep -E '^-D'
halcompile --userspace --print-flags | tr ' ' '\n' | grep -E '^-D'
# A program of a C source, with arguments for compiler and linker.
halcompile --compile --userspace --extra-compile-args="-DNAME=tooth -DTEETH=32" --extra-link-args="-lm -Wl,--as-needed" gear.c
printf 'loadusr -Wn tooth ./gear\ngetp tooth.teeth\ngetp tooth.root\n' > t.hal
halrun -f t.hal
# Two sources, one component.
halcompile --compile --outfile=both.so half_a.c half_b.c
printf 'loadrt both\ngetp both.n\n' > t.hal
halrun -f t.hal
# Pages, line ends of DOS and licences.
MANPAGER=cat MANWIDTH=80 halcompile --view-doc shown.comp 2>&1 | grep -c 'shown - A page to look at'
sed 's/$/\r/' shown.comp > dos.comp && sed -i 's/component shown/component dos/' dos.comp
halcompile --unix --require-license --preprocess dos.comp && grep -c $'\r' dos.c
sed -i '/license/d' dos.comp
halcompile --require-license --preprocess dos.comp
mkdir programs && printf '#!/usr/bin/python3\nprint("a tool of Python")\n' > tool.py
halcompile --install tool.py
halcompile --compile --userspace --extra-compile-args="-DNAME=tooth -DTEETH=32" --extra-link-args=-lno_such_library gear.c 2>&1 | grep -o 'cannot find -lno_such_library' | head -1
# What comes of a file stands beside it.
mkdir beside && cp shown.comp beside/
halcompile --preprocess beside/shown.comp
halcompile --document beside/shown.comp
halcompile --personalities=4 --adoc beside/shown.comp
ls beside
