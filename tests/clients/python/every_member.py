#!/usr/bin/python3
"""every_member.py [LOG]

Uses every member of linuxcnc.stat and linuxcnc.command on a running machine (machine/sim.ini) and writes an event log: each
call, how it ended, the messages that it brought, and which attributes of stat have changed since. Values that depend on time
are left out, so that two runs, and two systems, can be compared line by line.
"""
import os
import sys
import time

import linuxcnc

LOG = open(sys.argv[1], "w", buffering=1) if len(sys.argv) > 1 and not sys.argv[1].startswith("-") else sys.stdout
FOLDER = os.environ.get("KERF_TEST_FOLDER", os.path.dirname(os.path.abspath(__file__)))
TIMELESS = {"heartbeat", "taskbeat", "echo_serial_number", "cycle_time", "ini_filename", "lube", "lube_level"}
RCS = {-1: "time-out", 1: "done", 3: "error"}

s, c, e = linuxcnc.stat(), linuxcnc.command(), linuxcnc.error_channel()
last = {}


def say(*words):
    print(*words, file=LOG)


def plain(value):
    """Rounded, in order, without what differs from run to run."""
    if isinstance(value, float):
        return round(value, 4) + 0.0
    if isinstance(value, dict):
        return {k: plain(v) for k, v in sorted(value.items()) if not k.startswith("ferror")}
    if isinstance(value, (tuple, list)):
        out = [plain(v) for v in value]
        while len(out) > 3 and out[-1] == out[-2] == out[-3]:
            out.pop()
        return out
    if isinstance(value, str) and FOLDER in value:
        return value.replace(FOLDER, "FOLDER")
    return value


def names():
    return [n for n in dir(s) if not n.startswith("_") and not callable(getattr(s, n)) and n not in TIMELESS]


def changes(everything=False):
    s.poll()
    for name in names():
        value = plain(getattr(s, name))
        if everything or last.get(name) != value:
            old, new = last.get(name), value
            if not everything and isinstance(new, list) and new and isinstance(new[0], dict):
                for i, entry in enumerate(new):
                    before = old[i] if old and i < len(old) else {}
                    for key in entry:
                        if entry[key] != before.get(key):
                            say("    %s[%d].%s = %r" % (name, i, key, entry[key]))
            else:
                say("    %s = %r" % (name, value))
        last[name] = value


def settle(limit=8.0):
    """Until nothing moves and nothing waits; a paused program stays as it is."""
    end = time.time() + limit
    calm = 0
    while calm < 3 and time.time() < end:
        time.sleep(0.02)
        s.poll()
        moving = not s.paused and (s.state == linuxcnc.RCS_EXEC or not s.inpos or
                                   any(j["velocity"] for j in s.joint) or any(a["velocity"] for a in s.axis))
        calm = 0 if moving else calm + 1


def messages():
    while True:
        message = e.poll()
        if message is None:
            return
        say("    message", (message[0], plain(message[1])))


def call(name, *args, wait=5.0, show=True):
    text = "%s(%s)" % (name, ", ".join(repr(plain(a)) for a in args))
    try:
        result = getattr(c, name)(*args)
    except (linuxcnc.error, ValueError, TypeError) as problem:
        say(text, "raises", type(problem).__name__)
        return
    ended = RCS[c.wait_complete(wait)] if wait else "not waited for"
    settle()
    time.sleep(0.05)
    say(text, "->", result, ended)
    messages()
    if show:
        changes()


def constants():
    for name in sorted(dir(linuxcnc)):
        value = getattr(linuxcnc, name)
        if name.isupper() and isinstance(value, int):
            say("%s = %d" % (name, value))


def power():
    call("mdi", "G0 X1")
    call("auto", linuxcnc.AUTO_RUN, 0)
    call("home", -1)
    call("state", linuxcnc.STATE_ESTOP_RESET)
    call("state", linuxcnc.STATE_ON)


def jogs():
    call("mode", linuxcnc.MODE_MANUAL)
    call("traj_mode", linuxcnc.TRAJ_MODE_FREE)
    call("teleop_enable", 0)
    call("jog", linuxcnc.JOG_INCREMENT, True, 0, 20.0, 2.0)
    call("jog", linuxcnc.JOG_INCREMENT, True, 0, -20.0, 0.5)
    say("a continuous jog")
    c.jog(linuxcnc.JOG_CONTINUOUS, True, 1, 10.0)
    time.sleep(0.3)
    s.poll()
    say("    moves:", s.joint[1]["velocity"] > 9, "state", s.state, "inpos", s.inpos)
    c.jog(linuxcnc.JOG_STOP, True, 1)
    c.wait_complete()
    s.poll()
    say("    stands:", s.joint[1]["velocity"] == 0, s.joint_position[1] > 1)
    c.jog(linuxcnc.JOG_INCREMENT, True, 1, -20.0, s.joint_position[1])
    c.wait_complete()
    settle()
    changes()
    call("jog", linuxcnc.JOG_CONTINUOUS, True, 9, 10.0, wait=0)
    call("override_limits")
    call("home", -1)
    call("teleop_enable", 0)
    call("unhome", 1)
    call("home", 1)
    call("teleop_enable", 1)
    call("jog", linuxcnc.JOG_INCREMENT, False, 2, -20.0, 3.0)


def mdi():
    call("mdi", "G0 X1")
    call("mode", linuxcnc.MODE_MDI)
    call("mdi", "T2 M6")
    call("mdi", "G43 G0 X10 Y5 Z-30")
    call("mdi", "G0 X1 G1")
    call("mdi", "G10 L2 P2 X1 Y2 R10")
    call("mdi", "G55")
    call("mdi", "G92 X3")
    call("mdi", "G92.1")
    call("mdi", "G54 G20")
    call("mdi", "G21 G64 P0.5 Q0.1 F100 S300")
    call("mdi", "M66 P0 L3 Q0.1")
    call("mdi", "M64 P2")
    call("mdi", "M68 E1 Q3.5")
    call("mdi", "M3 S500")
    call("mdi", "M5")
    call("mdi", "G0 X9999")
    say("a line that takes its time")
    c.mdi("G4 P0.6")
    say("    at once:", RCS[c.wait_complete(0.1)])
    say("    at last:", RCS[c.wait_complete()])
    c.mdi("G1 X0 F600")
    time.sleep(0.3)
    s.poll()
    say("    state %d interp_state %d motion_type %d moves %s to go %s" % (
        s.state, s.interp_state, s.motion_type, s.current_vel > 9, s.distance_to_go > 0 and s.dtg[0] < 0))
    call("abort", show=False)
    call("mdi", "G0 X0 Y0")


def programs():
    call("mode", linuxcnc.MODE_AUTO)
    call("program_open", os.path.join(FOLDER, "nofile.ngc"))
    call("program_open", os.path.join(FOLDER, "part.ngc"))
    call("auto", linuxcnc.AUTO_RUN, 0)
    say("the same, paused on the way")
    c.auto(linuxcnc.AUTO_RUN, 0)
    time.sleep(0.3)
    call("auto", linuxcnc.AUTO_PAUSE, wait=0.1, show=False)
    s.poll()
    say("    paused %s task_paused %s interp_state %d motion_type %d line %d" % (
        s.paused, s.task_paused, s.interp_state, s.motion_type, s.motion_line))
    call("mode", linuxcnc.MODE_MANUAL, wait=0.1, show=False)
    call("mdi", "G0 X0", show=False)
    call("auto", linuxcnc.AUTO_RESUME)
    c.auto(linuxcnc.AUTO_STEP)
    c.wait_complete(2.0)
    s.poll()
    say("    a step: paused %s task_paused %s" % (s.paused, s.task_paused))
    call("abort")
    call("set_optional_stop", 1)
    call("set_block_delete", 1)
    call("set_optional_stop", 0)
    call("set_block_delete", 0)
    call("task_plan_synch")
    call("reset_interpreter")
    call("auto", linuxcnc.AUTO_RUN)
    call("auto", 17)


def by_hand():
    call("mode", linuxcnc.MODE_MANUAL)
    call("spindle", linuxcnc.SPINDLE_FORWARD, 1000)
    call("spindle", linuxcnc.SPINDLE_INCREASE)
    call("spindle", linuxcnc.SPINDLE_DECREASE)
    call("spindle", linuxcnc.SPINDLE_CONSTANT)
    call("spindle", linuxcnc.SPINDLE_OFF)
    call("spindle", linuxcnc.SPINDLE_REVERSE, 800, 0)
    call("brake", linuxcnc.BRAKE_ENGAGE)
    call("brake", linuxcnc.BRAKE_RELEASE)
    call("brake", linuxcnc.BRAKE_ENGAGE, 0)
    call("brake", linuxcnc.BRAKE_ENGAGE, 3)
    for name in ("flood", "mist"):
        call(name, 1)
        call(name, 0)
    call("feedrate", 0.5)
    call("rapidrate", 0.25)
    call("feedrate", 1.0)
    call("rapidrate", 1.0)
    call("maxvel", 30.0)
    call("maxvel", 120.0)
    call("spindleoverride", 0.7)
    call("spindleoverride", 1.0, 0)
    for on in (0, 1):
        call("set_feed_override", on)
        call("set_adaptive_feed", 1 - on)
        call("set_feed_hold", on)
        call("set_spindle_override", on)
    call("set_spindle_override", 1, 0)
    call("set_digital_output", 1, 1)
    call("set_digital_output", 99, 1)
    call("set_analog_output", 1, 2.5)
    call("set_min_limit", 0, -50.0)
    call("set_max_limit", 0, 50.0)
    call("debug", 3)
    call("debug", 0)
    call("tool_offset", 2, 20.5, 1.5, 4.0, 11.0, 22.0, 4)
    call("load_tool_table")
    call("text_msg", "a text")
    call("display_msg", "a display")
    call("error_msg", "an error")


def wrong():
    call("mode", 9)
    call("state", 9)
    call("flood", 7)
    call("mist", 7)
    call("brake", 5)
    call("spindle", 99)
    call("home", "x")
    call("mdi")
    call("program_open", 3)
    call("jog", linuxcnc.JOG_CONTINUOUS, True)
    call("jog", linuxcnc.JOG_CONTINUOUS, True, 0)
    call("jog", linuxcnc.JOG_INCREMENT, True, 0, 1.0)
    call("jog", 7, True, 0)
    call("teleop_enable", "x")
    call("debug", "x")
    call("wait_complete", "x")


def main():
    for _ in range(200):
        try:
            s.poll()
            break
        except linuxcnc.error:
            time.sleep(0.05)
    time.sleep(0.3)
    constants()
    say("at first")
    changes(everything=True)
    power()
    jogs()
    mdi()
    programs()
    by_hand()
    wrong()
    say("at last")
    changes(everything=True)
    if hasattr(s, "toolinfo"):
        say("toolinfo(7) = %r" % plain(s.toolinfo(7)))
    call("state", linuxcnc.STATE_OFF)
    call("state", linuxcnc.STATE_ESTOP)
    used = set(CALLED)
    say("methods not called:", sorted(n for n in dir(c) if not n.startswith("_") and callable(getattr(c, n)) and n not in used))
    say("end")


CALLED = {"jog", "wait_complete"}
_call = call


def call(name, *args, **options):
    CALLED.add(name)
    _call(name, *args, **options)


main()
