#!/usr/bin/env python3
"""How long a machine takes to start and to end: Kerf beside an installed LinuxCNC, in turns, with the same INI and HAL files.

start      from the call of the launcher until the machine is on, as its own client sees it
shutdown   from the end of the screen program until the launcher has ended
The screen is a script that switches the machine on: with `mdi` here, with the Python module `linuxcnc` there.
"""
import argparse
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

GOALS = {"start": 1 / 3, "shutdown": 1 / 2}

HAL = """loadrt [KINS]KINEMATICS
loadrt [EMCMOT]EMCMOT servo_period_nsec=[EMCMOT]SERVO_PERIOD num_joints=[KINS]JOINTS
addf motion-command-handler servo-thread
addf motion-controller servo-thread
net Xpos joint.0.motor-pos-cmd => joint.0.motor-pos-fb
net Ypos joint.1.motor-pos-cmd => joint.1.motor-pos-fb
net Zpos joint.2.motor-pos-cmd => joint.2.motor-pos-fb
net estop-loop iocontrol.0.user-enable-out => iocontrol.0.emc-enable-in
net tool-prep-loop iocontrol.0.tool-prepare => iocontrol.0.tool-prepared
net tool-change-loop iocontrol.0.tool-change => iocontrol.0.tool-changed
"""

LIMITS = "MIN_LIMIT = -100\nMAX_LIMIT = 100\nMAX_VELOCITY = 50\nMAX_ACCELERATION = 500\n"

INI = """[EMC]
MACHINE = startup
VERSION = 1.1
[DISPLAY]
DISPLAY = {screen}
[TASK]
TASK = milltask
CYCLE_TIME = 0.001
[RS274NGC]
PARAMETER_FILE = startup.var
[EMCMOT]
EMCMOT = motmod
COMM_TIMEOUT = 1
SERVO_PERIOD = 1000000
[EMCIO]
EMCIO = io
CYCLE_TIME = 0.1
TOOL_TABLE = tool.tbl
[HAL]
HALFILE = startup.hal
[KINS]
JOINTS = 3
KINEMATICS = trivkins coordinates=XYZ
[TRAJ]
COORDINATES = XYZ
LINEAR_UNITS = mm
ANGULAR_UNITS = degree
"""

OURS = """#!/bin/sh
mdi ':state estop-reset' ':state on' || exit 1
date +%s.%N > on
date +%s.%N > over
"""

THEIRS = """#!/usr/bin/python3
import linuxcnc, time
command, status = linuxcnc.command(), linuxcnc.stat()
command.state(linuxcnc.STATE_ESTOP_RESET)
command.state(linuxcnc.STATE_ON)
while True:
    status.poll()
    if status.task_state == linuxcnc.STATE_ON:
        break
    time.sleep(0.001)
open("on", "w").write(repr(time.time()))
open("over", "w").write(repr(time.time()))
"""


def make_machine(folder, screen_text):
    folder.mkdir()
    screen = folder / "screen"
    screen.write_text(screen_text)
    screen.chmod(0o755)
    text = INI.format(screen=screen)
    text += "".join(f"[AXIS_{axis}]\n{LIMITS}" for axis in "XYZ")
    text += "".join(f"[JOINT_{joint}]\nTYPE = LINEAR\nFERROR = 1\n{LIMITS}" for joint in range(3))
    (folder / "startup.ini").write_text(text)
    (folder / "startup.hal").write_text(HAL)
    (folder / "tool.tbl").write_text("T1 P1 D3\n")
    (folder / "startup.var").write_text("")
    for path in [folder, *folder.iterdir()]:
        path.chmod(path.stat().st_mode | 0o666 | (0o111 if path.is_dir() else 0))
    return folder


def run(folder, command, env):
    for name in ("on", "over"):
        (folder / name).unlink(missing_ok=True)
    begun = time.time()
    done = subprocess.run(command, env=env, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          timeout=60, check=False)
    ended = time.time()
    if not (folder / "over").exists():
        raise RuntimeError(f"{command[0]} did not come up:\n{done.stdout}{done.stderr}")
    return float((folder / "on").read_text()) - begun, ended - float((folder / "over").read_text())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build/release", help="build folder (default: build/release)")
    parser.add_argument("--pairs", type=int, default=7, help="runs of each (default: 7)")
    parser.add_argument("--linuxcnc", default="/usr/bin/linuxcnc", help="the installed launcher")
    options = parser.parse_args()
    build = pathlib.Path(options.build).resolve()
    peer = pathlib.Path(options.linuxcnc)
    with tempfile.TemporaryDirectory(prefix="kerf-startup-") as work:
        os.chmod(work, 0o777)
        ours = make_machine(pathlib.Path(work) / "ours", OURS)
        theirs = make_machine(pathlib.Path(work) / "theirs", THEIRS)
        env = {k: v for k, v in os.environ.items() if not k.startswith("KERF_") and k not in ("DISPLAY", "PYTHONPATH")}
        env.update(HOME=work, PATH="/usr/bin:/bin")
        our_env = {**env, "KERF_INSTANCE": f"startup{os.getpid()}"}
        their_env = {**env, "RTAPI_UID": "65534"}
        figures = {"Kerf": [], "LinuxCNC": []}
        for _ in range(options.pairs):
            figures["Kerf"].append(run(ours, [str(build / "bin/kerf"), "startup.ini"], our_env))
            if peer.exists():
                lock = ["flock", "/tmp/peer.lock"]
                # Waiting for the lock is not starting.
                subprocess.run([*lock, "true"], check=True)
                figures["LinuxCNC"].append(run(theirs, [*lock, str(peer), "-r", "startup.ini"], their_env))
    print(f"{'':10} {'Kerf':>22} {'LinuxCNC':>22}   ratio  goal")
    good = True
    for index, what in enumerate(("start", "shutdown")):
        median = {who: statistics.median(pair[index] for pair in pairs) for who, pairs in figures.items() if pairs}
        best = {who: min(pair[index] for pair in pairs) for who, pairs in figures.items() if pairs}
        columns = [f"{median[who]:7.3f} s (best {best[who]:.3f})" if who in median else "not installed" for who in figures]
        ratio = median["Kerf"] / median["LinuxCNC"] if "LinuxCNC" in median else float("nan")
        good = good and not ratio > GOALS[what]
        print(f"{what:10} {columns[0]:>22} {columns[1]:>22} {ratio:7.2f}  {GOALS[what]:.2f}")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
