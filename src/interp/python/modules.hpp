// The modules that embedded Python offers: interpreter, emccanon and the standard glue, over the compiled _kerf_interp.
#pragma once

namespace kerf::interp {

inline constexpr const char* kInterpreterModule = R"PY(
"""The interpreter, seen from functions in remap, oword and namedparams."""
import difflib
import enum
import _kerf_interp as _k


class InterpReturn(enum.IntEnum):
    INTERP_OK = 0
    INTERP_EXIT = 1
    INTERP_EXECUTE_FINISH = 2
    INTERP_ENDFILE = 3
    INTERP_FILE_NOT_OPEN = 4
    INTERP_ERROR = 5


FEED_MODE = enum.IntEnum("FEED_MODE", "UNITS_PER_MINUTE INVERSE_TIME UNITS_PER_REVOLUTION", start=0)
SPINDLE_MODE = enum.IntEnum("SPINDLE_MODE", "CONSTANT_RPM CONSTANT_SURFACE", start=0)
DISTANCE_MODE = enum.IntEnum("DISTANCE_MODE", "MODE_ABSOLUTE MODE_INCREMENTAL", start=0)
RETRACT_MODE = enum.IntEnum("RETRACT_MODE", "R_PLANE OLD_Z", start=0)
CUTTER_COMP_DIRECTION = enum.IntEnum("CUTTER_COMP_DIRECTION", "RIGHT LEFT")
for _e in (InterpReturn, FEED_MODE, SPINDLE_MODE, DISTANCE_MODE, RETRACT_MODE, CUTTER_COMP_DIRECTION):
    globals().update(_e.__members__)
INTERP_MIN_ERROR = 3
TOLERANCE_EQUAL = 0.0001
throw_exceptions = 1


class InterpreterException(Exception):
    """Lines given to execute() could not be executed."""

    def __init__(self, error_message, line_number=0, line_text=""):
        super().__init__(error_message)
        self.error_message = error_message
        self.line_number = line_number
        self.line_text = line_text

    def __str__(self):
        return self.error_message


def equal(a, b):
    return abs(a - b) < TOLERANCE_EQUAL


def is_near_int(value):
    return abs(value - round(value)) < TOLERANCE_EQUAL


def nearest_int(value):
    return round(value)


def _typed(found):
    if found is None:
        return None
    kind, value = found
    return value if kind == 0 else int(value) if kind == 1 else value != 0


class _Array:
    def __init__(self, name, length):
        self._name, self._length = name, length

    def __len__(self):
        return self._length

    def __getitem__(self, index):
        if not 0 <= index < self._length:
            raise IndexError(f"{self._name}[{index}]: 0 to {self._length - 1} exist")
        return _typed(_k.number(self._name, index))

    def __setitem__(self, index, value):
        if not 0 <= index < self._length:
            raise IndexError(f"{self._name}[{index}]: 0 to {self._length - 1} exist")
        if not _k.set_number(self._name, index, float(value)):
            raise AttributeError(f"{self._name} is read-only")


class PmCartesian:
    def __init__(self, x, y, z):
        self.x, self.y, self.z = x, y, z


class EmcPose:
    def __init__(self, v):
        self.tran = PmCartesian(v[0], v[1], v[2])
        self.x, self.y, self.z, self.a, self.b, self.c, self.u, self.v, self.w = v


class CANON_TOOL_TABLE:
    def __init__(self, row=None):
        self.toolno, self.pocketno, offset, self.diameter, self.frontangle, self.backangle, self.orientation = (
            row or (-1, -1, [0.0] * 9, 0.0, 0.0, 0.0, 0))
        self.offset = EmcPose(offset)


class _ToolTable:
    """[0] is the tool in the spindle, [n] the row of tool n."""

    def __getitem__(self, index):
        return CANON_TOOL_TABLE(_k.tool_in_spindle() if index == 0 else _k.tool(index))


class Params:
    """Numbered and named parameters: params[100], params["name"]; names with a leading _ are global."""

    def __getitem__(self, key):
        value = _k.parameter(key) if isinstance(key, int) else _k.named_parameter(str(key))
        if value is None:
            raise KeyError(key)
        return value

    def __setitem__(self, key, value):
        good = (_k.set_parameter(key, float(value)) if isinstance(key, int)
                else _k.set_named_parameter(str(key), float(value)))
        if not good:
            raise KeyError(f"{key} cannot be assigned to")

    def __contains__(self, key):
        return (_k.parameter(key) if isinstance(key, int) else _k.named_parameter(str(key))) is not None

    def __call__(self):
        return sorted(_k.parameter_names())

    def locals(self):
        return [n for n in self() if not n.startswith("_")]

    def globals(self):
        return [n for n in self() if n.startswith("_")]


class _Modes:
    def __init__(self, level, name, length):
        self._level, self._name, self._length = level, name, length

    def __len__(self):
        return self._length

    def __getitem__(self, index):
        return _typed(_k.block_number(self._level, self._name, index))


class Block:
    """One block: X_flag says whether it has the word x, x_number is its value."""

    def __init__(self, level):
        self.__dict__["_level"] = level

    def __getattr__(self, name):
        level = self._level
        if len(name) > 2 and name[1:] == "_flag":
            return _k.word(level, name[0]) is not None
        if len(name) > 2 and name[1:] in ("_number", "_number_float") and name[0] != "n":
            value = _k.word(level, name[0])
            if value is None:
                return -1 if name[0] in "hlpq" else 0.0
            return int(value) if name[0] in "tlh" else value
        if name in ("comment", "o_name"):
            return _k.block_text(level, name)
        if name in ("g_modes", "m_modes"):
            return _Modes(level, name, 17 if name == "g_modes" else 11)
        value = _typed(_k.block_number(level, name, 0))
        if value is None:
            raise AttributeError(f"a block has no {name}")
        return value


class _Blocks:
    def __getitem__(self, level):
        return Block(level)


class Context:
    def __init__(self, level):
        self.subname = _k.call_text(level, "subname")
        self.filename = _k.call_text(level, "filename")
        if self.subname is None:
            raise IndexError(f"sub_context[{level}]")


class _Contexts:
    def __getitem__(self, level):
        return Context(level)


_ARRAYS = {"speed": 8, "spindle_turning": 8, "spindle_mode": 8, "speed_override": 8,
           "active_g_codes": 17, "active_m_codes": 10, "active_settings": 5}
_NAMES = frozenset(_k.names())


class Interp:
    """`self` of functions. Attributes that it does not have may be added by the functions."""

    def __init__(self):
        put = lambda name, value: object.__setattr__(self, name, value)
        put("params", Params())
        put("parameters", self.params)
        put("blocks", _Blocks())
        put("sub_context", _Contexts())
        put("tool_table", _ToolTable())
        for name, length in _ARRAYS.items():
            put(name, _Array(name, length))

    def __getattr__(self, name):
        if name == "tool_offset":
            return EmcPose([_typed(_k.number(name, i)) for i in range(9)])
        if name in _NAMES:
            return _typed(_k.number(name, 0))
        value = _k.text(name)
        if value is not None:
            return value
        near = difflib.get_close_matches(name, list(_NAMES) + ["params", "blocks", "execute"], 1)
        raise AttributeError(f"the interpreter has no {name}" + (f"; did you mean {near[0]}?" if near else ""))

    def __setattr__(self, name, value):
        if name not in _NAMES:
            object.__setattr__(self, name, value)
        elif not _k.set_number(name, 0, float(value)):
            raise AttributeError(f"{name} is read-only")

    def __dir__(self):
        return sorted(set(object.__dir__(self)) | _NAMES)

    def execute(self, text=None, line_number=0):
        """Executes lines of G-code to their end; moves are queued."""
        if text is None:
            text = self._read
        good, error, line, line_text = _k.execute(str(text), int(line_number))
        if good:
            return INTERP_OK
        self.set_errormsg(error)
        if throw_exceptions:
            raise InterpreterException(error, line, line_text)
        return INTERP_ERROR

    def read(self, text):
        """Keeps a line for execute()."""
        object.__setattr__(self, "_read", text)
        return INTERP_OK

    def find_tool_pocket(self, number):
        tool = _k.tool(int(number))
        return (INTERP_ERROR, -1) if tool is None else (INTERP_OK, tool[1])

    def set_errormsg(self, text):
        _k.set_error(str(text))

    def get_errormsg(self):
        return _k.error_text()

    def load_tool_table(self):
        _k.canon("RELOAD_TOOLDATA", [])

    def set_tool_parameters(self):
        """#5400 to #5413 follow the tool in the spindle by themselves."""

    def synch(self):
        """The interpreter is synchronised when a function goes on after `yield INTERP_EXECUTE_FINISH`."""
        return INTERP_OK

    def stack(self):
        level, out = 0, []
        while _k.call_text(level, "subname") is not None:
            out.append((_k.call_text(level, "filename"), _k.call_text(level, "subname")))
            level += 1
        return out


this = Interp()
)PY";

inline constexpr const char* kCanonModule = R"PY(
"""Canonical functions. What is called here is queued like the calls of G-code."""
import enum as _enum
import _kerf_interp as _k
from interpreter import EmcPose as _EmcPose, this as _this

for _name, _members in {
        "CANON_UNITS": "UNITS_INCHES UNITS_MM UNITS_CM",
        "CANON_PLANE": "PLANE_XY PLANE_YZ PLANE_XZ PLANE_UV PLANE_VW PLANE_UW",
        "CANON_MOTION_MODE": "EXACT_STOP EXACT_PATH CONTINUOUS",
        "CANON_DIRECTION": "STOPPED CLOCKWISE COUNTERCLOCKWISE",
        "CANON_SIDE": "SIDE_RIGHT SIDE_LEFT SIDE_OFF",
        "CANON_FEED_REFERENCE": "WORKPIECE XYZ",
        "CANON_FEED_SPEED_MODE": "SYNCHED INDEPENDENT",
        "CANON_AXIS": "AXIS_X AXIS_Y AXIS_Z AXIS_A AXIS_B AXIS_C AXIS_U AXIS_V AXIS_W"}.items():
    globals()[_name] = _enum.IntEnum(_name, ["CANON_" + m for m in _members.split()])
    globals().update(globals()[_name].__members__)


def _function(name):
    def call(*arguments):
        problem = _k.canon(name, [a if isinstance(a, str) else float(a) for a in arguments])
        if problem:
            raise ValueError(problem)
    call.__name__ = name
    return call


for _name in _k.canon_names():
    globals()[_name] = _function(_name)
    globals()["enqueue_" + _name] = globals()[_name]


def _hal(pin, default):
    value = _k.named_parameter("_hal[" + pin + "]")
    return default if value is None else value


def GET_EXTERNAL_DIGITAL_INPUT(index, default=0):
    return int(_hal("motion.digital-in-%02d" % index, default))


def GET_EXTERNAL_ANALOG_INPUT(index, default=0.0):
    return _hal("motion.analog-in-%02d" % index, default)


def _position(first):
    def read():
        return _k.parameter(first)
    return read


for _i, _axis in enumerate("XYZABCUVW"):
    globals()["GET_EXTERNAL_PROBE_POSITION_" + _axis] = _position(5061 + _i)
    globals()["GET_EXTERNAL_POSITION_" + _axis] = (lambda a: lambda: _k.named_parameter("_abs_" + a))(_axis.lower())


for _i, _axis in enumerate("XYZABCUVW"):
    globals()["GET_EXTERNAL_TOOL_LENGTH_" + _axis + "OFFSET"] = (lambda i: lambda: _k.number("tool_offset", i)[1])(_i)


def GET_EXTERNAL_PROBE_TRIPPED_VALUE():
    return int(_k.parameter(5070))


def GET_EXTERNAL_OFFSETS():
    return _EmcPose([_k.number("tool_offset", i)[1] for i in range(9)])


def GET_EXTERNAL_FEED_RATE():
    return _this.feed_rate


def GET_EXTERNAL_SPEED(spindle=0):
    return _this.speed[spindle]


def GET_EXTERNAL_SPINDLE(spindle=0):
    return CANON_DIRECTION(_this.spindle_turning[spindle])


def GET_EXTERNAL_SPINDLE_OVERRIDE_ENABLE(spindle=0):
    return int(_this.speed_override[spindle])


def GET_EXTERNAL_FEED_OVERRIDE_ENABLE():
    return int(_this.feed_override)


def GET_EXTERNAL_PLANE():
    return CANON_PLANE(_this.plane)


def GET_EXTERNAL_FLOOD():
    return int(_this.flood)


def GET_EXTERNAL_MIST():
    return int(_this.mist)


def GET_EXTERNAL_TOOL_SLOT():
    return _this.current_pocket


def GET_EXTERNAL_SELECTED_TOOL_SLOT():
    return _this.selected_pocket


def GET_EXTERNAL_TC_FAULT():
    return int(_k.parameter(5600))


def GET_EXTERNAL_TOOL_TABLE(pocket):
    return _this.tool_table[pocket]


def GET_EXTERNAL_QUEUE_EMPTY():
    return 1


def __getattr__(name):
    raise AttributeError(f"emccanon.{name} is not there for Python; use self.execute() with G-code")
)PY";

inline constexpr const char* kGlueModule = R"PY(
"""The standard glue of remapped codes. Kerf has it built in: these functions are for scripts that import it."""
import _kerf_interp as _k
from interpreter import INTERP_OK


def _glue(name):
    def function(self, **words):
        return _k.glue(name) or INTERP_OK
    function.__name__ = name
    return function


for _name in ("prepare_prolog", "prepare_epilog", "change_prolog", "change_epilog", "settool_prolog",
              "settool_epilog", "setspeed_prolog", "setspeed_epilog", "setfeed_prolog", "setfeed_epilog",
              "cycle_prolog", "cycle_epilog", "ignore_m6", "index_lathe_tool_with_wear"):
    globals()[_name] = _glue(_name)


def init_stdglue(self):
    """Nothing to prepare."""
)PY";

}  // namespace kerf::interp
