halcompile --compile always_home.comp
nm -D --defined-only always_home.so | awk '{print $3}' | sort | tr '\n' ' '
echo
printf 'loadrt always_home\nshow pin\nlist comp\n' > t.hal
halrun -f t.hal
halcompile --document always_home.comp
sed -n '/SYNOPSIS/,/PINS/p' always_home.9
