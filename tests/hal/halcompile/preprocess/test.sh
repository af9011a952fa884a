halcompile again.comp
ls
halcompile --compile again.c
mkdir -p elsewhere
KERF_COMPONENTS=$PWD/elsewhere halcompile --install again.comp
ls elsewhere
halcompile --preprocess --outfile other.c again.comp && cmp <(sed s/other.c/again.c/ other.c) again.c
printf 'loadrt threads name1=t period1=1000000\nloadrt again\naddf again.0 t\nsetp again.0.in 4\nstart\nloadusr -w sleep 0.1\ngetp again.0.out\n' > t.hal
halrun -f t.hal
halcompile -P 9
# What the compiler says names the .comp file and its line.
sed 's/in + 1/inn + 1/' again.comp > bad.comp && sed -i 's/component again/component bad/' bad.comp
LC_ALL=C halcompile --compile bad.comp 2>&1 | grep error: | sed 's/ error: .*/ error/'
printf 'component cond;\npin in bit a if personalty & 1;\nfunction _;\nlicense "GPL";\n;;\nFUNCTION(_) { }\n' > cond.comp
LC_ALL=C halcompile --compile cond.comp 2>&1 | grep error: | sed 's/ error: .*/ error/'
printf '#!/usr/bin/python3\nprint("hello")\n' > tool.py
halcompile --compile tool.py
halcompile --compile nothing.comp
halcompile --frob again.comp
