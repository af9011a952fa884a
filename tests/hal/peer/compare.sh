#!/bin/sh
# compare.sh [BIN [CASE ...]]: our halcmd's text and the installed LinuxCNC's, script by script. Skips (77) when there is no LinuxCNC.
here=$(dirname "$0")
exec python3 "$here/compare.py" --peer "${@:-$here/../../../build/dev/bin}"
