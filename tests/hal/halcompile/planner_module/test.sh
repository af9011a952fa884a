halcompile --compile my_tp.comp
nm -D --defined-only my_tp.so | awk '{print $3}' | sort | tr '\n' ' '
echo
printf 'loadrt my_tp\nshow pin\n' > t.hal
halrun -f t.hal
