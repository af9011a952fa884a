# Read by the other scripts: `. "$(dirname "$0")/lib/common.sh"`. Changes to the repository's top and sets what all share.
# shellcheck shell=bash disable=SC2034

caller_dir=$PWD # relative names that the user gave are meant from here
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
cd "$root" || exit 1
me=scripts/$(basename "$0")

die() {
  echo "$me: $*" >&2
  exit 1
}

# Prints the comment block at the head of the calling script, which is its help text, and ends.
usage() {
  sed -n '2,/^[^#]/{/^#/{s/^# \{0,1\}//;p}}' "$root/$me"
  exit 0
}

wrong_use() {
  echo "$me: $*" >&2
  echo "Try: $me --help" >&2
  exit 2
}

# The compiler cache outlives the build trees, and clones of this repository share it.
export CCACHE_DIR=${CCACHE_DIR:-${HOME:-/tmp}/.cache/ccache}
export CCACHE_BASEDIR=$root CCACHE_NOHASHDIR=1
jobs=${KERF_JOBS:-$(nproc)}

# quietly LOG TITLE COMMAND...: output goes to LOG and its end is shown when the command fails; at a terminal it is shown as it comes.
quietly() {
  local log=$1 title=$2
  shift 2
  mkdir -p "$(dirname "$log")"
  if [[ -t 1 ]]; then
    "$@"
    return
  fi
  if "$@" >"$log" 2>&1; then return 0; fi
  echo "$me: $title failed; the end of $log:" >&2
  # A failed ninja goes on for a while with what was running: show the failures themselves first.
  grep -nE '(^FAILED:|error:|Error )' "$log" | head -20 >&2 || true
  tail -n 40 "$log" >&2
  return 1
}

# Programs and modules in the folders $2 (a regular expression, such as 'bin|components') of the build tree $1, as targets.
programs() {
  ninja -C "$1" -t targets all |
    sed -nE "s#^(($2)/[^/:]*): CXX_(EXECUTABLE|MODULE_LIBRARY|SHARED_LIBRARY)_LINKER.*#\\1#p" | sort
}

# build_targets PRESET TARGET...: with tests in the build tree.
build_targets() {
  local preset=$1 options=() target
  shift
  for target in "$@"; do options+=(-t "$target"); done
  scripts/build "$preset" --tests on "${options[@]}"
}
