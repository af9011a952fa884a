"""Waits for scripts that drive a machine.

    l = linuxcnc_util.LinuxCNC()
    l.wait_for_linuxcnc_startup()
    l.command.home(-1)
    l.wait_for_home([1, 1, 1])

What does not come in time is a LinuxCNC_Exception.
"""
import time

import linuxcnc

_LOOK_EVERY_S = 0.01
_AXES = "xyzabcuvw"


class LinuxCNC_Exception(Exception):
    """Something did not come in time."""


class LinuxCNC:
    """`command`, `status` and `error` are made when they are not given."""

    def __init__(self, command=None, status=None, error=None):
        self.command = command or linuxcnc.command()
        self.status = status or linuxcnc.stat()
        self.error = error or linuxcnc.error_channel()

    def _wait(self, done, timeout, what):
        end = time.time() + timeout
        while True:
            self.status.poll()
            if done():
                return
            if time.time() >= end:
                raise LinuxCNC_Exception("%s: not within %g seconds" % (what, timeout))
            time.sleep(_LOOK_EVERY_S)

    def wait_for_linuxcnc_startup(self, timeout=10.0):
        end = time.time() + timeout
        while True:
            try:
                self.status.poll()
                return
            except linuxcnc.error as problem:
                if time.time() >= end:
                    raise LinuxCNC_Exception("no machine within %g seconds: %s" % (timeout, problem)) from problem
            time.sleep(_LOOK_EVERY_S)

    def all_joints_homed(self, joints):
        """`joints`: one truth value a joint; those that are true must be homed."""
        self.status.poll()
        return all(self.status.homed[n] for n, wanted in enumerate(joints) if wanted)

    def wait_for_home(self, joints, timeout=10.0):
        self._wait(lambda: self.all_joints_homed(joints), timeout, "joints %s homed" % list(joints))

    def wait_for_interp_state(self, target_state, timeout=10.0):
        self._wait(lambda: self.status.interp_state == target_state, timeout, "interp_state %s" % target_state)

    def wait_for_tool_in_spindle(self, expected_tool, timeout=10.0):
        self._wait(lambda: self.status.tool_in_spindle == expected_tool, timeout, "tool %s in the spindle" % expected_tool)

    def _place(self, axis_letter):
        return self.status.position[_AXES.index(axis_letter.lower())]

    def wait_for_axis_to_stop(self, axis_letter, timeout=10.0):
        before = [None]

        def stands():
            now = self._place(axis_letter)
            same, before[0] = before[0] == now, now
            return same and self.status.inpos
        self._wait(stands, timeout, "axis %s at rest" % axis_letter)

    def wait_for_axis_to_stop_at(self, axis_letter, target, timeout=10.0, tolerance=0.0001):
        self._wait(lambda: abs(self._place(axis_letter) - target) < tolerance and self.status.inpos, timeout,
                   "axis %s at %g" % (axis_letter, target))

    def jog_axis(self, axis_letter, target, vel=5.0, timeout=10.0):
        """Jogs an axis to a place and waits until it is there. Needs manual mode and teleop."""
        self.status.poll()
        distance = target - self._place(axis_letter)
        if abs(distance) > 0:
            self.command.jog(linuxcnc.JOG_INCREMENT, 0, _AXES.index(axis_letter.lower()),
                             vel if distance > 0 else -vel, abs(distance))
        self.wait_for_axis_to_stop_at(axis_letter, target, timeout, tolerance=0.001)
