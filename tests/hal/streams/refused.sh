# Each program with what it does not take; all of it on stdout, the exit codes too.
exec 2>&1
say() { echo "\$ $*"; "$@"; echo "= $?"; }
printf '%s\n' '# a comment' '1 2.5' '' '2 1' '1 x' '1' '0 3 4 ignored' 'overrun' > lines.tmp
say halstreamer lines.tmp
printf '1 1\n0 0\n' | say halstreamer -N from-a-pipe
say halstreamer -c 3 lines.tmp
say halstreamer -c x
say halstreamer -c
say halstreamer no-such-file
say halstreamer a b
say halsampler -c 1
say halsampler -n x
say halsampler -n 1 no-such-folder/x
say halsampler a b
rm lines.tmp
