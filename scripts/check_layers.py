#!/usr/bin/env python3
"""scripts/check_layers.py [--root DIR]

Checks every #include of src/ and components/ against the table of docs/architecture.md ("Who may include whom"), and
where third-party and system headers may be used. Tests are exempt. Prints FILE:LINE: complaint; exit 1 when there are any.
"""
import argparse
import pathlib
import re
import sys

# What HAL offers to processes beside the realtime host.
HAL_CLIENT = ["hal/client", "hal/core/types.hpp", "hal/core/view.hpp"]

# Folder of the including file -> folders (prefixes) it may include from, besides its own. The longest matching key rules.
ALLOWED = {
    "rtapi": [],
    "rtapi/host": ["hal", "rtapi"],  # rtapi_app: the one realtime program loads HAL components
    "ini": [],
    "hal": ["rtapi"],
    "hal/cmd": ["hal", "rtapi", "ini"],
    "hal/tcl": ["hal", "rtapi", "ini"],
    "motion/api": ["rtapi/base", "rtapi/sync"],
    "motion/core": ["motion/api", "rtapi/base"],
    "motion/motmod": ["motion/api", "motion/core", "hal", "rtapi"],
    "motion/replay": ["motion/api", "motion/core", "motion/motmod", "hal", "rtapi"],
    "interp": ["rtapi/base"],
    "interp/config": ["rtapi/base", "ini"],  # settings from an INI file, beside the interpreter
    "interp/rs274": ["rtapi/base", "ini"],   # the program
    "io": ["rtapi", *HAL_CLIENT, "ini"],
    "task": ["rtapi", "ini", "interp", "io", "motion/api", *HAL_CLIENT],
    "launcher": ["rtapi", "ini", *HAL_CLIENT, "hal/core/value_text.hpp", "hal/cmd",  # it carries out the HAL files
                  "task/api", "motion/api"],
    "clients": ["rtapi", "ini", *HAL_CLIENT, "task/api", "motion/api"],
    "gateway": ["rtapi", "ini", *HAL_CLIENT, "task/api", "motion/api"],
    "python": ["rtapi", "ini", *HAL_CLIENT, "hal/component.hpp", "hal/stream.hpp", "hal/shared_memory.hpp",
               "hal/core/port.hpp", "hal/core/value_text.hpp", "task/api", "motion/api", "clients/common", "interp"],
    "components": ["hal/component.hpp", "hal/operator_line.hpp", "hal/port_pins.hpp", "hal/stream.hpp", "hal/stream_channels.hpp", "hal/channels.hpp", "hal/core/types.hpp", "rtapi/base"],
    "components/tools": ["hal/component.hpp", "hal/stream.hpp", "hal/core/types.hpp", "rtapi/base", "motion/api"],
    "components/kinematics": ["hal/component.hpp", "hal/core/types.hpp", "rtapi/base", "rtapi/sync", "motion/api"],
    "components/drivers": ["hal/component.hpp", "hal/core/types.hpp", "rtapi/base", "io/devices"],
}

# Third-party header (pattern) -> where it may stand. `.cpp`: only in sources, since these headers are slow to compile.
THIRD_PARTY = [
    (r"boost/interprocess/", r"src/rtapi/shm/"),
    (r"boost/(asio|beast)", r"src/gateway/.*\.cpp$"),
    (r"boost/", None),
    (r"nlohmann/", r"src/(hal|task|launcher|clients|io|gateway|python)/.*\.cpp$"),
    (r"CLI/", r"src/(hal/cmd|hal/tools|interp|task|launcher|clients|io|gateway|rtapi/host)/.*\.cpp$"),
    (r"fmt/", r"src/.*\.cpp$"),
    (r"(editline/|histedit\.h)", r"src/(hal/cmd|hal/tcl|launcher|task|clients)/.*\.cpp$"),
    (r"(yaml-cpp|modbus|gpiod)", r"(src/io/devices|components/drivers)/"),
    (r"(tcl|pybind11/|Python\.h)", r"src/(hal/tcl|interp|python|task)/"),
    (r"(gtest|gmock|benchmark)/", None),
]

# Folders that must know nothing of threads and the operating system.
PURE = r"src/(motion/(api|core)|interp)/"
OS_HEADERS = (r"(thread|mutex|shared_mutex|condition_variable|future|chrono|semaphore|pthread\.h|sched\.h|unistd\.h|fcntl\.h"
              r"|signal\.h|csignal|time\.h|ctime|poll\.h|sys/.*)$")
# interp reads its files itself (pread), so plain file calls are its own.
PURE_EXCEPTIONS = [(r"src/interp/python/", r"(thread|mutex|condition_variable|chrono)$"),  # embedded Python has its own thread
                   (r"src/interp/", r"(unistd\.h|fcntl\.h|sys/stat\.h|sys/types\.h|ctime)$")]
# Realtime arithmetic does no stream or stdio at all.
RT_PURE = r"(src/motion/(core|motmod)|components)/"
IO_HEADERS = r"(iostream|fstream|sstream|ostream|istream|iomanip|cstdio|stdio\.h|regex|filesystem)$"

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def under(path, prefix):
    return path == prefix or path.startswith(prefix.rstrip("/") + "/")


def layer_of(where):
    """where: path from src/, or components/..."""
    return max((key for key in ALLOWED if under(where, key)), key=len, default=None)


def check_own(where, target, exists):
    """An include of ours; returns a complaint or None."""
    layer = layer_of(where)
    if layer is None:
        return f"folder of {where} is not in the layer table (scripts/check_layers.py)"
    if not exists:
        return f'"{target}" is not a header below src/; write includes from there'
    module = layer.split("/")[0]
    own = layer_of(target) or target
    # Within one module the parts of `motion` and `components` are layers of their own; elsewhere a part may use its module.
    if own == layer or (module == own.split("/")[0] and module not in ("motion", "components", "rtapi", "hal")):
        return None
    if module in ("rtapi", "hal") and own == module:
        return None
    if any(under(target, allowed) for allowed in ALLOWED[layer]):
        return None
    return f"{layer} may not use {target}; it may use {', '.join(ALLOWED[layer]) or 'nothing of the project'}"


def check_foreign(path, name):
    for pattern, place in THIRD_PARTY:
        if re.match(pattern, name):
            if place and re.match(place, path):
                return None
            return f"<{name}> may stand only in {place}" if place else f"<{name}> may not be used here"
    if re.match(PURE, path) and re.match(OS_HEADERS, name):
        if not any(re.match(p, path) and re.match(h, name) for p, h in PURE_EXCEPTIONS):
            return f"<{name}>: this folder knows nothing of threads and the operating system"
    if re.match(RT_PURE, path) and re.match(IO_HEADERS, name):
        return f"<{name}>: realtime code does no stream or file work"
    return None


def check_tree(root):
    complaints = []
    for top in ("src", "components"):
        base = root / top
        if not base.is_dir():
            continue
        for file in sorted(base.rglob("*")):
            if file.suffix not in (".hpp", ".cpp", ".h", ".c"):
                continue
            path = file.relative_to(root).as_posix()
            where = path[len("src/"):] if top == "src" else path
            for number, line in enumerate(file.read_text(errors="replace").splitlines(), 1):
                found = INCLUDE.match(line)
                if not found:
                    continue
                quote, name = found.groups()
                if quote == "<":
                    complaint = check_foreign(path, name)
                else:
                    target = name
                    header = root / "src" / name
                    exists = header.is_file()
                    if not exists and name.startswith("components/"):
                        exists = (root / name).is_file()
                    elif not exists and (file.parent / name).is_file() and top == "components":
                        # Components may name helpers of their own folder directly.
                        target = (file.parent / name).resolve().relative_to(root).as_posix()
                        exists = True
                    complaint = check_own(where, target, exists)
                if complaint:
                    complaints.append(f"{path}:{number}: {complaint}")
    return complaints


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--root", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parent.parent)
    complaints = check_tree(parser.parse_args().root.resolve())
    for complaint in complaints:
        print(complaint, file=sys.stderr)
    if complaints:
        print(f"check_layers.py: {len(complaints)} complaints", file=sys.stderr)
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
