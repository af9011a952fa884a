"""A machine in Python.

    import linuxcnc
    s, c, e = linuxcnc.stat(), linuxcnc.command(), linuxcnc.error_channel()
    c.mode(linuxcnc.MODE_MDI)
    c.mdi("G0 X10")
    if c.wait_complete(60) != linuxcnc.RCS_DONE:
        print(e.poll())
    s.poll()
    print(s.position)

The instance is that of KERF_INSTANCE. docs/python.md tells the rest.
"""
import os as _os
from collections import namedtuple as _namedtuple

from _linuxcnc import (command, draw_dwells, draw_lines, error, error_channel, gui_respect_offsets, gui_rot_offsets, ini,
                       line9, positionlogger, stat, version, vertex9)

STATE_ESTOP, STATE_ESTOP_RESET, STATE_OFF, STATE_ON = 1, 2, 3, 4
MODE_MANUAL, MODE_AUTO, MODE_MDI = 1, 2, 3
AUTO_RUN, AUTO_PAUSE, AUTO_RESUME, AUTO_STEP, AUTO_REVERSE, AUTO_FORWARD = range(6)
EXEC_ERROR, EXEC_DONE, EXEC_WAITING_FOR_MOTION, EXEC_WAITING_FOR_MOTION_QUEUE, EXEC_WAITING_FOR_IO = 1, 2, 3, 4, 5
EXEC_WAITING_FOR_MOTION_AND_IO, EXEC_WAITING_FOR_DELAY, EXEC_WAITING_FOR_SYSTEM_CMD = 7, 8, 9
EXEC_WAITING_FOR_SPINDLE_ORIENTED = 10
INTERP_IDLE, INTERP_READING, INTERP_PAUSED, INTERP_WAITING = 1, 2, 3, 4
TRAJ_MODE_FREE, TRAJ_MODE_COORD, TRAJ_MODE_TELEOP = 1, 2, 3
RCS_DONE, RCS_EXEC, RCS_ERROR = 1, 2, 3
JOG_STOP, JOG_CONTINUOUS, JOG_INCREMENT = 0, 1, 2
SPINDLE_OFF, SPINDLE_FORWARD, SPINDLE_REVERSE = 0, 1, -1
SPINDLE_INCREASE, SPINDLE_DECREASE, SPINDLE_CONSTANT = 10, 11, 12
BRAKE_RELEASE, BRAKE_ENGAGE = 0, 1
FLOOD_OFF, FLOOD_ON = 0, 1
MIST_OFF, MIST_ON = 0, 1
LINEAR, ANGULAR = 1, 2
MOTION_TYPE_TRAVERSE, MOTION_TYPE_FEED, MOTION_TYPE_ARC = 1, 2, 3
MOTION_TYPE_TOOLCHANGE, MOTION_TYPE_PROBING, MOTION_TYPE_INDEXROTARY = 4, 5, 6
KINEMATICS_IDENTITY, KINEMATICS_FORWARD_ONLY, KINEMATICS_INVERSE_ONLY, KINEMATICS_BOTH = 1, 2, 3, 4
NML_ERROR, NML_TEXT, NML_DISPLAY = 1, 2, 3
OPERATOR_ERROR, OPERATOR_TEXT, OPERATOR_DISPLAY = 11, 12, 13
MAX_JOINTS, MAX_AXIS = 16, 9
DEBUG_CONFIG, DEBUG_VERSIONS, DEBUG_TASK_ISSUE, DEBUG_NML = 2, 8, 16, 64
DEBUG_MOTION_TIME, DEBUG_INTERP, DEBUG_RCS, DEBUG_INTERP_LIST = 128, 256, 512, 2048
DEBUG_OWORD, DEBUG_REMAP, DEBUG_PYTHON, DEBUG_STATE_TAGS = 8192, 16384, 32768, 524288

PREFIX = _os.path.dirname(_os.path.dirname(_os.path.dirname(_os.path.abspath(__file__))))
SHARE = _os.path.join(PREFIX, "share")
#: There is no NML; scripts hand this name on.
nmlfile = _os.path.join(SHARE, "linuxcnc", "linuxcnc.nml")


class tool(_namedtuple("tool_result", [
        "id", "xoffset", "yoffset", "zoffset", "aoffset", "boffset", "coffset", "uoffset", "voffset", "woffset",
        "diameter", "frontangle", "backangle", "orientation"])):
    """One entry of stat.tool_table."""
    __slots__ = ()

    def __new__(cls, values):
        return super().__new__(cls, *values)


tool.__name__ = tool.__qualname__ = "tool_result"
