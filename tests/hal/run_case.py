#!/usr/bin/env python3
"""run_case.py BUILD CASE.hal [--virtual]

Runs a HAL script by the true programs in an instance of its own, from the script's folder; with --virtual on the virtual clock.
Compares what comes on stdout with CASE.expected, when there is such a file. Exit code 0: the script ended well and said what
was expected.
"""
import difflib
import os
import pathlib
import subprocess
import sys
import time


def wait_for_host(halcmd):
    for _ in range(1000):
        if subprocess.run([halcmd, "-Q", "unlock", "all"], capture_output=True).returncode == 0:
            return
        time.sleep(0.02)
    sys.exit("the realtime host does not start")


def run(build, script, virtual):
    programs = pathlib.Path(build).resolve() / "bin"
    os.environ["KERF_INSTANCE"] = f"test-case-{os.getpid()}"
    os.environ.pop("KERF_RUN_ID", None)
    os.environ["PATH"] = f"{programs}:{os.environ['PATH']}"
    os.chdir(script.parent)
    if not virtual:
        return subprocess.run([programs / "halrun", "-f", script.name], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE)
    host = subprocess.Popen([programs / "rtapi_app", "--virtual"], stdin=subprocess.DEVNULL)
    try:
        wait_for_host(programs / "halcmd")
        return subprocess.run([programs / "halcmd", "-f", script.name], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE)
    finally:
        host.terminate()
        host.wait()


def main():
    script = pathlib.Path(sys.argv[2]).resolve()
    done = run(sys.argv[1], script, "--virtual" in sys.argv[3:])
    said = done.stdout.decode()
    if done.returncode != 0:
        sys.exit(f"{said}\n{script.name} ended with {done.returncode}")
    expected = script.with_suffix(".expected")
    if not expected.exists():
        print(said, end="")
    elif said != expected.read_text():
        sys.exit("\n".join(difflib.unified_diff(expected.read_text().splitlines(), said.splitlines(), str(expected), "said",
                                                lineterm="")))


main()
