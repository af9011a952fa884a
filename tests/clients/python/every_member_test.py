#!/usr/bin/python3
"""every_member.py against our own machine: the event log is every_member.golden. --write makes that anew."""
import difflib
import os
import subprocess
import sys

import machine

GOLDEN = os.path.join(machine.HERE, "every_member.golden")

with machine.Machine() as m:
    log = os.path.join(m.folder, "log")
    ended = subprocess.run([sys.executable, os.path.join(machine.HERE, "every_member.py"), log],
                           env=dict(os.environ, PYTHONPATH=os.path.join(machine.BUILD, "python")), timeout=500)
    assert ended.returncode == 0, ended.returncode
    text = open(log).read()
if "--write" in sys.argv:
    open(GOLDEN, "w").write(text)
wanted = open(GOLDEN).read()
if text != wanted:
    sys.stdout.writelines(difflib.unified_diff(wanted.splitlines(True), text.splitlines(True), "every_member.golden", "this run", n=2))
    sys.exit("the event log differs; `every_member_test.py --write` makes the golden file anew")
