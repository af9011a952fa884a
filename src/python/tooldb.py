"""tooldb: the Kerf side of [EMCIO]DB_PROGRAM for programs in Python (manual: "Tool Database Interface").

    from tooldb import tooldb_tools, tooldb_callbacks, tooldb_loop

    tooldb_tools([10, 11])                                  # the tool numbers; again whenever they change
    tooldb_callbacks(get_tool, put_tool, load_spindle, unload_spindle)
    tooldb_loop()                                           # until Kerf ends

get_tool(toolno) gives the line of a tool as in a tool table file; a list of lines is joined. The others are called as f(toolno, params),
with params the tool data line in capitals ("T10 P10 Z1.5 D0.25"), and may give a text to answer with. An exception in any of them is
answered with NAK and its text: the operator reads it, and the machine goes on.
"""

import sys

TOOLDB_VERSION = "v2.1"

_tools = []
_callbacks = {}


def tooldb_tools(tools):
    """The numbers of the tools there are."""
    numbers = [int(n) for n in tools]
    if any(n < 0 for n in numbers):
        raise ValueError("tooldb_tools: tool numbers are 0 or greater")
    _tools[:] = sorted(numbers)


def tooldb_callbacks(user_get_tool, user_put_tool, user_load_spindle, user_unload_spindle):
    """The four functions."""
    _callbacks.update(g=user_get_tool, p=user_put_tool, l=user_load_spindle, u=user_unload_spindle)


def _reply(text):
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def _tool_number(params):
    for word in params.split():
        if word[0] == "T":
            return int(word[1:])
    raise ValueError(f"no T in '{params}'")


def _one_line(value):
    if isinstance(value, (list, tuple)):
        value = " ".join(str(part) for part in value)
    return str(value).strip().replace("\n", " ")


def _do(line):
    command, params = line[0].lower(), line[1:].strip()
    params = params.split(";")[0].strip().upper()
    if command == "g":
        lines = [_one_line(_callbacks["g"](number)) for number in _tools]
        for text in lines:
            _reply(text)
        return "FINI"
    if command not in _callbacks:
        raise ValueError(f"unknown command '{line}'")
    said = _callbacks[command](_tool_number(params), params)
    return _one_line(said) if said else f"FINI {command}"


def tooldb_loop():
    """Answers Kerf until it closes the connection."""
    if len(_callbacks) != 4:
        raise RuntimeError("tooldb_loop: call tooldb_callbacks first")
    _reply(TOOLDB_VERSION)
    for line in sys.stdin:
        line = line.strip()
        if not line:
            continue
        try:
            answer = _do(line)
        except Exception as error:  # whatever the user's functions raise
            answer = f"NAK {_one_line(error) or type(error).__name__}"
        _reply(answer)
