#!/usr/bin/env python3
"""Compares what our halcmd prints with what LinuxCNC's prints, script by script.

  compare.py BIN [CASE ...]            our programs in BIN against the checked-in `expected`
  compare.py --peer BIN [CASE ...]     also the installed LinuxCNC 2.9 against `expected` (skips with a reason when there is none)
  compare.py --write [CASE ...]        write `expected` anew from the installed LinuxCNC

A case is a folder with test.hal, `options` for halrun (default -k) and the files that the script names. `expected` holds the
peer's text in the newest format: standard output, then the messages. See README.md for what is converted and what is left out.
Exit: 0 equal, 1 different, 77 skipped.
"""

import argparse
import concurrent.futures
import difflib
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
PEER = "/usr/bin/halrun"
LOCK = "/tmp/peer.lock"
SKIP = 77

TITLES = {
    f"ID      Type  {'Name':<47} PID   State": f"ID      Type  {'Name':<55} PID   State",
    "Owner   Type  Dir         Value  Name": "Owner   Type  Dir                 Value  Name",
    "Type          Value  Name     (linked to)": "Type                  Value  Name     (linked to)",
    f" {'Alias':<47}  Original Name": f" {'Alias':<55}  Original Name",
    "Owner   CodeAddr  Arg       FP   Users  Name": "Owner   CodeAddr      Arg           FP   Users   Name",
}
NOISE = re.compile(r"Running with fallback_uid|Note: Using POSIX|rtapi_app: |halrun: |ERROR: rtapi_app failed to die|\S+ \S+ rtapi_app")
ITEM = re.compile(r"^ *\d+  (\w+) +(IN|OUT|I/O|RO|RW) +(\S+)  (\S.*)$")
ITEM_SCRIPT = re.compile(r"^(\S+ +\w+ +(?:IN|OUT|I/O|RO|RW)) (\S+) (\S+\.time)$")
COMPONENT = re.compile(r"^ *\d+  (User|RT|Other) +(\S+) +(?:\d+ )?(ready|initializing)$")
SIGNAL = re.compile(r"^(bit|float|s32|u32|s64|u64|port) +(\S+)  (\S+)$")
FUNCTION = re.compile(r"^ \d+  [0-9a-f]+  [0-9a-f]+  (?:YES|NO ) +(\d+)   (\S+)$")
FUNCTION_SCRIPT = re.compile(r"^(\S+) [0-9a-f]{12} [0-9a-f]{12} (?:YES|NO) +(\d+) (\S+)$")
THREAD = re.compile(r"^ *(\d+)  (?:YES|NO) +(\S+) \( *\d+, *\d+ \)$")
THREAD_SCRIPT = re.compile(r"^(\d+) (?:YES|NO) (\S+) +\d+ \d+(.*)$")
ALIAS = re.compile(r"^ (\S+) +(\S+)$")
SETP = re.compile(r"^setp (\S+) +(\S+)$")


def newest(text, script):
    """Standard output of either program, in the newest format and with X and T for what differs from run to run."""
    # The peer ends these without a new line.
    text = re.sub(r"((?:Unl|L)ocking completed)(?=.)", r"\1\n", text)
    out = []
    for line in text.splitlines():
        if NOISE.match(line) or line.endswith(".threadbeat") or line in ("Echo on", "Echo off"):
            continue
        # Only the peer says these.
        if re.search(r": (setting parameter '|Component 'x?\w+' ready$|Program '\S+rtapi_app' started)", line):
            continue
        line = TITLES.get(line, line)
        line = re.sub(r"\S+\.threadbeat ", "", line)
        line = re.sub(r"^ {25}(?=<==|==>|<=>)", " " * 33, line)
        line = re.sub(r"^(Signal|.*: Signal) '(\S+)' deleted'$", r"\1 '\2' deleted", line)
        if m := COMPONENT.match(line):
            if not m[2].startswith("halcmd"):
                out.append(f"     X  {m[1]:<4}  {m[2]:<55}       {m[3]}")
            continue
        if script:
            if m := FUNCTION_SCRIPT.match(line):
                line = f"{m[1]} X X YES {m[2]:>3} {m[3]}"
            elif m := THREAD_SCRIPT.match(line):
                line = f"{m[1]} YES {m[2]} T T{m[3]}"
            elif m := ITEM_SCRIPT.match(line):
                line = f"{m[1]} T {m[3]}"
        elif m := ITEM.match(line):
            value = "T" if re.search(r"\.time( |$)", m[4]) else m[3]
            line = f"     X  {m[1]:<5} {m[2]:<3}{value:>22}  {m[4]}"
        elif m := SIGNAL.match(line):
            line = f"{m[1]:<5}{m[2]:>22}  {m[3]}"
        elif m := FUNCTION.match(line):
            line = f" X  X  X  YES  {m[1]:>5}   {m[2]}"
        elif m := THREAD.match(line):
            line = f"{m[1]:>11}  YES  {m[2]:>20} ( T, T )"
        elif m := ALIAS.match(line):
            line = f" {m[1]:<55}  {m[2]}"
        if m := SETP.match(line):
            line = f"setp {m[1]} {m[2]:>20}"
        if line.startswith(("loadrt ", "newsig ")):
            line = line.rstrip()
        line = re.sub(r"(used/total shared memory: +).*", r"\1X", line)
        line = re.sub(r"(active/recycled components: +).*", r"\1X", line)
        line = re.sub(r"(active/recycled \w+: +\d+)/.*", r"\1/X", line)
        out.append(line)
    return out


def peers_errors(text):
    """One line for each failed command: "newsig failed: REASON" for the library's reason and halcmd's line after it."""
    out = []
    reason = None
    for line in text.splitlines():
        if NOISE.match(line):
            continue
        line = line.replace("HALCMD MSG: (null)", "HALCMD MSG:").rstrip()
        if line.startswith("HAL: ERROR: "):
            if reason:
                out.append(reason)
            reason = line[len("HAL: ERROR: "):]
            continue
        if reason and re.search(r"\w+ failed$", line):
            out.append(f"{line}: {reason}")
            reason = None
            continue
        if reason:
            out.append(reason)
            reason = None
        # The reason stands before.
        if re.search(r": (setp|sets|newsig) failed$|: insmod for \S+ failed, returned -1$", line):
            continue
        line = re.sub(r"^(Could not open hal file)", r"FILE: \1", line)
        out.append(line)
    if reason:
        out.append(reason)
    return out


def our_errors(text):
    """Without what we add: the next step after "; ", and the place of what the peer gives none."""
    out = []
    for line in text.splitlines():
        if NOISE.match(line):
            continue
        line = re.sub(r"; .*| \(out of range\)$", "", line).rstrip()
        line = re.sub(r"^\S+:\d+: (?:delsig|start|stop) failed: ", "", line)
        line = re.sub(r"^\S+:\d+: (Could not open hal file)", r"FILE: \1", line)
        out.append(line)
    return out


def options_of(case):
    path = HERE / case / "options"
    return path.read_text().split() if path.exists() else ["-k"]


def run(argv, case, environment):
    with tempfile.TemporaryDirectory() as folder:
        for path in (HERE / case).iterdir():
            if path.name not in ("expected", "options"):
                shutil.copy(path, folder)
        done = subprocess.run(argv, cwd=folder, env=environment, stdin=subprocess.DEVNULL, timeout=60,
                              capture_output=True, check=False)
    return done.stdout.decode(errors="replace"), done.stderr.decode(errors="replace"), done.returncode


def environment(**more):
    env = {k: v for k, v in os.environ.items() if k != "PEER_NONE"}
    env.update(PEER_VAR="value", **more)
    return env


def text_of(out, errors, code):
    return "\n".join([*out, "--- messages", *errors, f"--- exit {0 if code == 0 else 1}"]) + "\n"


def ours(case, bin_folder):
    name = f"peer-{os.getpid()}-{case}"[:39]
    options = options_of(case)
    out, err, code = run([f"{bin_folder}/halrun", *options, "test.hal"], case, environment(KERF_INSTANCE=name))
    return text_of(newest(out, "-s" in options), our_errors(err), code)


def peers(case):
    options = options_of(case)
    env = environment()
    if os.geteuid() == 0:
        env.update(RTAPI_UID="65534", RTAPI_FIFO_PATH="/tmp/.rtapi_fifo_peer")
    script = f'{PEER} "$@"; code=$?; {PEER} -U >/dev/null 2>&1; exit $code'
    before = None
    # Once in a while a session of the peer dies: only what came twice counts.
    for _ in range(6):
        out, err, code = run(["flock", LOCK, "bash", "-c", script, "x", *options, "test.hal"], case, env)
        text = text_of(newest(out, "-s" in options), peers_errors(err), code)
        if text == before:
            return text
        if out or err:
            before = text
    sys.exit(f"{case}: {PEER} gives no answer twice the same")


def differs(case, expected, got, who):
    if expected == got:
        return False
    sys.stdout.writelines(difflib.unified_diff(expected.splitlines(True), got.splitlines(True),
                                               f"{case}/expected", f"{case} {who}"))
    return True


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--peer", action="store_true")
    parser.add_argument("--write", action="store_true")
    parser.add_argument("words", nargs="*", metavar="BIN or CASE")
    args = parser.parse_args()
    if (args.peer or args.write) and not os.access(PEER, os.X_OK):
        print(f"skipped: no {PEER}; install linuxcnc-uspace")
        return SKIP
    bin_folder = None
    cases = args.words
    if not args.write:
        if not cases:
            parser.error("BIN, the folder of our programs, is missing")
        bin_folder, cases = Path(cases[0]).resolve(), cases[1:]
    cases = cases or sorted(p.parent.name for p in HERE.glob("*/test.hal"))

    if args.write:
        for case in cases:
            (HERE / case / "expected").write_text(peers(case))
        return 0

    bad = set()
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        for case, got in zip(cases, pool.map(lambda c: ours(c, bin_folder), cases)):
            if differs(case, (HERE / case / "expected").read_text(), got, "ours"):
                bad.add(case)
    if args.peer:
        for case in cases:
            if differs(case, (HERE / case / "expected").read_text(), peers(case), "LinuxCNC"):
                bad.add(case)
    print(f"{len(cases)} scripts, {len(bad)} with a difference")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
