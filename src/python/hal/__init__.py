"""HAL components in Python.

    import hal, time
    c = hal.component("passthrough")
    c.newpin("in", hal.HAL_FLOAT, hal.HAL_IN)
    c.newpin("out", hal.HAL_FLOAT, hal.HAL_OUT)
    c.ready()
    try:
        while True:
            time.sleep(0.1)
            c["out"] = c["in"]
    except KeyboardInterrupt:
        pass

`halcmd unloadusr` comes as a KeyboardInterrupt. docs/python-hal.md tells the rest.
"""
import atexit as _atexit
import enum as _enum
import os as _os
import signal as _signal
import warnings as _warnings

import _hal
from _hal import (component_exists, component_is_ready, connect, disconnect, error, get_info_params, get_info_pins,
                  get_info_signals, get_msg_level, get_p, get_s, get_value, is_initialized, item, new_sig,
                  pin_has_writer, sampler_base, set_msg_level, set_p, set_s, shm, stream, streamer_base)


class Type(_enum.IntEnum):
    """Types of pins, parameters and signals."""
    BOOL = 1
    REAL = 2
    SINT = 6
    UINT = 7
    PORT = 5
    S32 = 3
    U32 = 4
    HAL_BOOL = 1
    HAL_REAL = 2
    HAL_SINT = 6
    HAL_UINT = 7
    HAL_PORT = 5
    HAL_S32 = 3
    HAL_U32 = 4


class Dir(_enum.IntEnum):
    """Directions of pins and parameters."""
    IN = 16
    OUT = 32
    IO = 48
    RO = 64
    RW = 192
    HAL_IN = 16
    HAL_OUT = 32
    HAL_IO = 48
    HAL_RO = 64
    HAL_RW = 192


class CompType(_enum.IntEnum):
    """Kinds of components."""
    UNKNOWN = -1
    USER = 0
    REALTIME = 1
    OTHER = 2


class RTType(_enum.IntEnum):
    """What runs the realtime threads."""
    UNINITIALIZED = -1
    NONE = 0
    UNKNOWN = 1
    PREEMPT_DYNAMIC = 2
    PREEMPT_RT = 3
    RTAI = 4
    LXRT = 5
    XENOMAI = 6
    XENOMAI_EVL = 7


HAL_BIT = HAL_BOOL = 1
HAL_FLOAT = HAL_REAL = 2
HAL_S32 = 3
HAL_U32 = 4
HAL_PORT = 5
HAL_S64 = HAL_SINT = 6
HAL_U64 = HAL_UINT = 7
HAL_IN = 16
HAL_OUT = 32
HAL_IO = 48
HAL_RO = 64
HAL_RW = 192
MSG_NONE = 0
MSG_ERR = 1
MSG_WARN = 2
MSG_INFO = 3
MSG_DBG = 4
MSG_ALL = 5
for _name, _member in RTType.__members__.items():
    globals()["REALTIME_TYPE_" + _name] = int(_member)
del _name, _member
is_kernelspace = 0
is_userspace = 1
kernel_version = "Not Available"


def get_realtime_type():
    """What runs the realtime threads of the instance: a member of RTType."""
    is_virtual = _hal._clock_is_virtual()
    if is_virtual is None:
        return RTType.UNINITIALIZED
    kernel = _os.uname().version
    if not is_virtual and ("PREEMPT_RT" in kernel or "PREEMPT RT" in kernel):
        return RTType.PREEMPT_RT
    if not is_virtual and "PREEMPT_DYNAMIC" in kernel:
        return RTType.PREEMPT_DYNAMIC
    return RTType.NONE


def __getattr__(name):
    if name in ("is_rt", "is_sim"):
        _warnings.warn(f"hal.{name} is deprecated; use hal.get_realtime_type()", FutureWarning, stacklevel=2)
        realtime = get_realtime_type() > RTType.PREEMPT_DYNAMIC
        return int(realtime == (name == "is_rt"))
    if name == "query":
        import importlib
        return importlib.import_module("hal.query")
    raise AttributeError(f"module 'hal' has no attribute {name!r}")


class _ItemWrap:
    """What pins and parameters have in common."""

    def __new__(cls, item):
        if not isinstance(item, _hal.item):
            raise TypeError(f"Constructor argument must be _hal.item: {type(item)}")
        self = object.__new__(cls)
        self._item = item
        names = ["get", "set", "get_name", "get_type", "get_dir", "is_pin"]
        if item.get_type() == HAL_PORT:
            names += ["read", "peek", "peek_commit", "write", "clear", "size", "readable", "writable"]
        for name in names:
            setattr(self, name, getattr(item, name))
        return self

    name = property(lambda self: self._item.get_name(), doc="Name without the component's prefix")
    type = property(lambda self: self._item.get_type(), doc="HAL_BIT and its like")
    dir = property(lambda self: self._item.get_dir(), doc="HAL_IN and its like")
    value = property(lambda self: self._item.get(), lambda self, value: self._item.set(value), doc="The value")


class Pin(_ItemWrap):
    """A pin of a component of this process."""

    def __new__(cls, item):
        self = super().__new__(cls, item)
        if not item.is_pin():
            raise TypeError("Must be constructed from pin object")
        return self


class Param(_ItemWrap):
    """A parameter of a component of this process."""

    def __new__(cls, item):
        self = super().__new__(cls, item)
        if item.is_pin():
            raise TypeError("Must be constructed from param object")
        return self


class component(_hal.component):
    """component(name, prefix=name): pins and parameters that this process owns."""

    __module__ = "hal"

    def newpin(self, name, type, dir):
        """Makes a pin "PREFIX.name"."""
        return Pin(_hal.component.newpin(self, name, type, dir))

    def newparam(self, name, type, dir):
        """Makes a parameter "PREFIX.name"."""
        return Param(_hal.component.newparam(self, name, type, dir))

    def getpin(self, name):
        """The pin, or AttributeError."""
        return Pin(_hal.component.getpin(self, name))

    def getparam(self, name):
        """The parameter, or AttributeError."""
        return Param(_hal.component.getparam(self, name))

    # Called for names that are no method: a pin or parameter whose name is a Python name.
    def __getattr__(self, name):
        return self[name]

    def __setattr__(self, name, value):
        self[name] = value


_atexit.register(_hal._end)

# `halcmd unloadusr` sends SIGTERM; a program that has no handler of its own sees it as Ctrl-C.
try:
    if _signal.getsignal(_signal.SIGTERM) == _signal.SIG_DFL:
        _signal.signal(_signal.SIGTERM, _signal.default_int_handler)
except ValueError:  # imported by a thread that is not the first: signals are not ours to set
    pass
