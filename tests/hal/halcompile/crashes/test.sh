# EXTRA_SETUP comes before the pins: the realtime host dies, and halcmd says where to look.
halcompile --compile early_pin.comp >/dev/null
printf 'loadrt and2\nloadrt or2\nloadrt early_pin\nloadrt not\n' > t.hal
halrun -f t.hal 2>&1 | grep -o 't.hal.*' | sed 's|the other side is gone|gone|'
