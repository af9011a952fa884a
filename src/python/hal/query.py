"""Everything that HAL has, as dicts.

pin(name), param(name), signal(name), comp(name or id), funct(name) and thread(name) give one object or None; pins(), params(),
signals(), comps(), functs() and threads() give all as {name: dict}; signalpins(signal) the pins that are linked to it.
"""
import _hal

from hal import CompType, Dir, Type


def _item(about):
    if about is not None:
        about["type"] = Type(about["type"])
        about["dir"] = Dir(about["dir"])
    return about


def _signal(about):
    if about is not None:
        about["type"] = Type(about["type"])
    return about


def _comp(about):
    about["type"] = CompType(about["type"])
    return about


def _by_name(objects, finish=lambda about: about):
    return {about["name"]: finish(about) for about in objects}


def pin(name):
    """About a pin, by its name or alias; or None."""
    return _item(_hal.query_pin(name))


def pins():
    """All pins."""
    return _by_name(_hal.query_pins(), _item)


def param(name):
    """About a parameter, by its name or alias; or None."""
    return _item(_hal.query_param(name))


def params():
    """All parameters."""
    return _by_name(_hal.query_params(), _item)


def signal(name):
    """About a signal; or None."""
    return _signal(_hal.query_signal(name))


def signals():
    """All signals."""
    return _by_name(_hal.query_signals(), _signal)


def signalpins(name):
    """The pins of a signal; None when there is no such signal."""
    found = _hal.query_signal_pins(name)
    return None if found is None else _by_name(found, _item)


def comp(name_or_id):
    """About a component, by its name or number; or None."""
    key = "id" if isinstance(name_or_id, int) else "name"
    for about in _hal.query_comps():
        if about[key] == name_or_id:
            return _comp(about)
    return None


def comps():
    """All components."""
    return _by_name(_hal.query_comps(), _comp)


def funct(name):
    """About a realtime function; or None."""
    return functs().get(name)


def functs():
    """All realtime functions."""
    return _by_name(_hal.query_functs())


def thread(name):
    """About a realtime thread and its functions; or None."""
    return threads().get(name)


def threads():
    """All realtime threads."""
    return _by_name(_hal.query_threads())
