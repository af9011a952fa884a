#!/usr/bin/env bash
# scripts/check_rt_symbols.sh [build directory]
#
# Proves by the symbol tables that realtime code reaches no allocator, no stdio and no blocking lock: every symbol that
# the archives of <build directory>/rt_archives.txt and the components need must be defined in one of these archives or be
# allowed by scripts/rt_symbols_allowed.txt (one extended regular expression a line, matched against the whole name).
# Default: build/dev. Prints FILE(MEMBER): SYMBOL for what is not allowed.
set -euo pipefail
. "$(dirname "$0")/lib/common.sh"

case ${1-} in -h | --help) usage ;; esac
dir=${1:-build/dev}
[[ -f $dir/rt_archives.txt ]] || die "$dir/rt_archives.txt is missing; run scripts/build dev"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
files=()
while read -r file; do
  if [[ ! $file ]]; then continue; fi
  [[ -f $file ]] || die "$file is not built; run scripts/build dev"
  files+=("$file")
done <"$dir/rt_archives.txt"
for file in "$dir"/components/*.so; do
  if [[ -f $file ]]; then files+=("$file"); fi
done
if ((${#files[@]} == 0)); then
  echo "$me: no realtime code in $dir"
  exit
fi

grep -vE '^[[:space:]]*(#|$)' scripts/rt_symbols_allowed.txt >"$work/allowed"
: >"$work/defined"
: >"$work/needed"
for file in "${files[@]}"; do
  short=${file#"$root/"}
  short=${short#"$dir/"}
  if [[ $file == *.so ]]; then
    nm -D -uC "$file" | sed "s|^ *[UwWvV] ||; s|^|$short\t|" >>"$work/needed"
  else
    nm -C --defined-only "$file" 2>/dev/null | sed -nE 's/^[0-9a-f]+ [A-Za-z] //p' >>"$work/defined"
    # Members of an archive are headed by "name.o:".
    nm -uC "$file" 2>/dev/null | awk -v file="$short" '
      /:$/ { member = substr($0, 1, length($0) - 1); next }
      /^ *[UwWvV] / { sub(/^ *[UwWvV] /, ""); print file "(" member ")\t" $0 }' >>"$work/needed"
  fi
done
sort -u "$work/defined" -o "$work/defined"

# Versions such as @GLIBC_2.29 are not part of the name.
bad=$(sed -E 's/@+[A-Za-z_0-9.]+$//' "$work/needed" | sort -u |
  awk -F'\t' 'FILENAME == ARGV[1] { defined[$0] = 1; next } !($2 in defined)' "$work/defined" - |
  awk -F'\t' '
    FILENAME == ARGV[1] { allowed[++n] = "^(" $0 ")$"; next }
    { for (i = 1; i <= n; i++) if ($2 ~ allowed[i]) next
      print $1 ": " $2 }' "$work/allowed" -)
if [[ $bad ]]; then
  echo "$bad" >&2
  die "realtime code needs symbols that scripts/rt_symbols_allowed.txt does not allow"
fi
