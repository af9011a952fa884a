#!/usr/bin/env python3
"""scripts/compatibility.py: makes docs/compatibility.md, and says which names have no verdict yet.

What users of LinuxCNC know by name stands in docs/compatibility/SECTION.tsv, one name a line:
  NAME <tab> VERDICT <tab> NOTE
VERDICT is works, differs (the note says how) or no (the note says why; "not yet": it is to come). Lines that begin with # are comments; a line
`## TITLE` begins a table of its own on the page. The names must be those that our own code declares: programs by their
manual pages, INI keys by the table in src/ini/keys (scripts/ini_keys.py writes ini.tsv), halcmd's words by its table, pins by those of a running machine, Python names by the module itself,
remote commands by the shell's table. A name with the verdict no is not declared: LinuxCNC has it, Kerf has not.

  scripts/compatibility.py             write docs/compatibility.md
  scripts/compatibility.py --check     compare page, verdicts and declarations (exit 1: they differ)
  scripts/compatibility.py --missing   print the declared names without a row, and those whose "not yet" is out of date

Declarations that need a built tree (pins, Python) are taken from build/dev, or from $KERF_BUILD_DIR, and are
skipped with a word when it is not there.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

TOP = Path(__file__).resolve().parents[1]
DATA = TOP / "docs/compatibility"
PAGE = TOP / "docs/compatibility.md"
BUILD = Path(os.environ.get("KERF_BUILD_DIR", TOP / "build/dev")).resolve()
VERDICTS = ("works", "differs", "no")
SOON = "not yet"
FOREIGN = "not part of Kerf"  # begins the note of what runs with Kerf and comes from elsewhere


class Unavailable(Exception):
    """A declaration that cannot be asked here, with the reason."""


# -- declarations: each function gives the set of names that our code declares ----------------------------------------


def programs():
    return {page.stem for page in (TOP / "docs/man/man1").glob("*.1")}


def ini_keys():
    kerf = BUILD / "bin/kerf"
    if not kerf.exists():
        raise Unavailable("kerf is not built")
    text = subprocess.run([kerf, "keys", "--tsv"], capture_output=True, text=True, check=True).stdout
    rows = [line.split("\t") for line in text.splitlines()[1:] if not line.startswith("# ")]
    return {f"[{row[0]}]{row[1]}" for row in rows if row[7] != "no"}


def halcmd_words():
    table = (TOP / "src/hal/cmd/commander.cpp").read_text()
    return set(re.findall(r'^\s+\{"(\w+)", \d+, \w+, .*?&Commander::', table, re.M))


def general(name):
    """joint.2.homed -> joint.N.homed: one name for all joints, spindles, axes and numbered inputs."""
    name = re.sub(r"^((?:halui\.)?axis)\.[xyzabcuvw]\.", r"\1.L.", name)
    name = re.sub(r"^ini\.[xyzabcuvw]\.", "ini.L.", name)
    name = re.sub(r"^(motion\.tooloffset|halui\.tool\.length_offset)\.[xyzabcuvw]$", r"\1.L", name)
    name = re.sub(r"^((?:halui\.)?(?:joint|spindle)|ini)\.\d+\.", r"\1.N.", name)
    return re.sub(r"-\d\d$", "-MM", name)


def machine_pins():
    """Pins of configs/sim/mill with halui, by their general names."""
    kerf, halcmd = BUILD / "bin/kerf", BUILD / "bin/halcmd"
    if not kerf.exists() or not halcmd.exists():
        raise Unavailable("kerf and halcmd are not built")
    with tempfile.TemporaryDirectory(prefix="kerf_pins_") as folder:
        # The machine lists its own pins and ends: no waiting from outside, the same on a slow computer.
        script = Path(folder) / "list"
        script.write_text(f'#!/bin/sh\n"{halcmd}" -s show pin >"{folder}/pins"\n')
        script.chmod(0o755)
        ini = (TOP / "configs/sim/mill/mill.ini").read_text()
        machine = Path(folder) / "machine.ini"
        for name in (TOP / "configs/sim/mill").iterdir():
            (Path(folder) / name.name).write_bytes(name.read_bytes())
        has_halui = (BUILD / "bin/halui").exists() and not re.search(r"^HALUI *=", ini, re.M)
        ini = re.sub(r"^DISPLAY *=.*$", "", ini, flags=re.M)
        # iov2 has all the pins of a tool changer.
        machine.write_text(f"{ini}\n[DISPLAY]\nDISPLAY = {script}\n[EMCIO]\nEMCIO = iov2\n"
                           + ("[HAL]\nHALUI = halui\n[HALUI]\nMDI_COMMAND = G0 X0\n" if has_halui else ""))
        env = {**os.environ, "KERF_INSTANCE": f"pins-{os.getpid()}", "XDG_STATE_HOME": f"{folder}/state", "PATH": f"{BUILD}/bin:{os.environ['PATH']}"}
        run = subprocess.run([kerf, machine], env=env, capture_output=True, text=True, check=False, timeout=120,
                             stdin=subprocess.DEVNULL)
        pins = Path(folder) / "pins"
        if not pins.exists() or not pins.read_text().strip():
            raise Unavailable(f"the machine did not start: {run.stdout}{run.stderr}")
        lines = [line.split() for line in pins.read_text().splitlines()]
        return {general(words[4]) for words in lines if len(words) > 4}


def asked_pins():
    """What motmod has only when its parameters or the kinematics ask for it."""
    out = set()
    names = " ".join(f"names_{kind}=NAME" for kind in ("din", "dout", "ain", "aout", "misc_errors"))
    for kinematics, asked in (("xyzac-trt-kins", "num_joints=5 unlock_joints_mask=7 num_misc_error=1"),
                              ("trivkins coordinates=xyz kinstype=BOTH", f"num_joints=4 num_extrajoints=1 {names}")):
        with tempfile.NamedTemporaryFile("w", suffix=".hal") as hal:
            hal.write(f"loadrt {kinematics}\nloadrt motmod servo_period_nsec=1000000 {asked}\nshow pin\n")
            hal.flush()
            env = {**os.environ, "KERF_INSTANCE": f"asked-{os.getpid()}", "PATH": f"{BUILD}/bin:{os.environ['PATH']}"}
            run = subprocess.run([BUILD / "bin/halrun", "-f", hal.name], env=env, capture_output=True, text=True,
                                 check=False, timeout=120, stdin=subprocess.DEVNULL)
        lines = [line.split() for line in run.stdout.splitlines()]
        pins = {general(words[4]) for words in lines if len(words) > 4}
        if not pins:
            raise Unavailable(f"motmod did not load: {run.stdout}{run.stderr}")
        out |= pins
    return out


def hal_pins():
    own = re.compile(r"^(motion|spindle|joint|axis|ini|iocontrol)\.")
    return {name for name in machine_pins() | asked_pins() if own.match(name)}


def halui_pins():
    if not (BUILD / "bin/halui").exists():
        raise Unavailable("halui is not built")
    return {name for name in machine_pins() if name.startswith("halui.")}


def python_names():
    """linuxcnc.NAME, stat.NAME, command.NAME, error_channel.NAME, ini.NAME, positionlogger.NAME."""
    folder = BUILD / "python"
    if not folder.is_dir() or not list(folder.glob("linuxcnc*")):
        raise Unavailable("the Python module linuxcnc is not built")
    ask = ("import linuxcnc\n"
           "for n in dir(linuxcnc):\n"
           "    if not n.startswith('_'): print('linuxcnc.' + n)\n"
           "for c in ('stat', 'command', 'error_channel', 'ini', 'positionlogger'):\n"
           "    for n in dir(getattr(linuxcnc, c, None)):\n"
           "        if hasattr(linuxcnc, c) and not n.startswith('_'): print(c + '.' + n)\n")
    run = subprocess.run([sys.executable, "-c", ask], env={**os.environ, "PYTHONPATH": str(folder)}, capture_output=True,
                         text=True, check=False, timeout=60)
    if run.returncode != 0:
        raise Unavailable(f"import linuxcnc: {run.stderr.strip()}")
    return set(run.stdout.split())


def remote_commands():
    """`get NAME`, `set NAME` and the commands: the rows of the tables in src/clients/rsh."""
    folder = TOP / "src/clients/rsh"
    names = set(re.findall(r'^ +{"(\w+)", "', (folder / "table.cpp").read_text(), re.M))
    for file in folder.glob("rows_*.cpp"):
        for row in re.split(r"{\.name = ", file.read_text())[1:]:
            name = row.split('"')[1]
            names |= {f"{word} {name}" for word in ("get", "set") if re.search(rf"\.{word} =", row)}
    return names


class Section:
    def __init__(self, stem, title, intro, declared):
        self.path, self.title, self.intro, self.declared = DATA / f"{stem}.tsv", title, intro, declared


SECTIONS = [
    Section("ini", "INI keys", "Types, defaults and meanings: [configuration.md](configuration.md). L is an axis letter, n a number.",
            ini_keys),
    Section("programs", "Programs", "Programs of LinuxCNC by the names scripts call.", programs),
    Section("halcmd", "halcmd", "Commands of `halcmd` and of HAL files.", halcmd_words),
    Section("hal-pins", "HAL pins", "Pins of a running machine; N is a number, L an axis letter, MM two digits.", hal_pins),
    Section("halui", "halui", "Pins of `halui`; N is a number, L an axis letter, MM two digits.", halui_pins),
    Section("python", "Python", "Names of the module `linuxcnc`; `stat.x` is attribute x of an object of `linuxcnc.stat()`.",
            python_names),
    Section("remote-shell", "Remote shell", "Commands of `linuxcncrsh`.", remote_commands),
]


# -- data files -------------------------------------------------------------------------------------------------------


def read_rows(path):
    """[(title or "", name, verdict, note)] of a data file; exits with its faults."""
    rows, faults, title, seen = [], [], "", {}
    for number, line in enumerate(path.read_text().splitlines(), 1):
        if line.startswith("## "):
            title = line[3:].strip()
        if line.startswith("#") or not line.strip():
            continue
        words = line.split("\t")
        words += [""] * (3 - len(words))
        name, verdict, note = words[:3]
        place = f"{path.relative_to(TOP)}:{number}"
        if len(words) > 3 or verdict not in VERDICTS:
            faults.append(f"{place}: expected NAME<tab>{'|'.join(VERDICTS)}<tab>NOTE, found {line!r}")
        elif verdict != "works" and not note:
            faults.append(f"{place}: {name}: say in the third column {'how it differs' if verdict == 'differs' else 'why'}")
        elif name in seen:
            faults.append(f"{place}: {name} stands in line {seen[name]} already")
        seen.setdefault(name, number)
        rows.append((title, name, verdict, note))
    if faults:
        sys.exit("\n".join(faults))
    return rows


def cell(text):
    return text.replace("|", r"\|")


def page():
    out = ["# What of LinuxCNC works", "",
           "Made by `scripts/compatibility.py` from [docs/compatibility](compatibility); edit those files, not this one.",
           "**works**: as LinuxCNC's manual says. **differs**: there, but not the same. **no**: not there, with the reason.", ""]
    tables = [(s, read_rows(s.path)) for s in SECTIONS]
    # No counts here: they would make two changes of different sections collide.
    out += [f"* [{s.title}](#{s.title.lower().replace(' ', '-')})" for s, _ in tables]
    for s, rows in tables:
        out += ["", f"## {s.title}", "", s.intro]
        shown = None
        for title, name, verdict, note in rows:
            if title != shown:
                out += ([""] + [f"### {title}"] if title else []) + ["", "| name | verdict | |", "|---|---|---|"]
                shown = title
            out.append(f"| `{cell(name)}` | {verdict} | {cell(note)} |")
    return "\n".join(out) + "\n"


# -- commands ---------------------------------------------------------------------------------------------------------


def compare(section):
    """(declared without a row, said to be there and not declared, the opposite, declared and "not yet")"""
    rows = {name: (verdict, note) for _, name, verdict, note in read_rows(section.path)}
    declared = section.declared()
    external = {name for name, (_, note) in rows.items() if note.startswith(FOREIGN)}
    empty = {name for name, (verdict, _) in rows.items() if verdict != "no" and name not in declared} - external
    wrong = {name for name, (verdict, note) in rows.items() if verdict == "no" and name in declared and note != SOON}
    done = {name for name, (verdict, note) in rows.items() if note == SOON and name in declared}
    return sorted(declared - set(rows)), sorted(empty), sorted(wrong), sorted(done)


def check():
    faults = []
    for section in SECTIONS:
        name = section.path.relative_to(TOP)
        try:
            missing, empty, wrong, _ = compare(section)
        except Unavailable as reason:
            print(f"skipped {name}: {reason}")
            continue
        faults += [f"{name}: no row for {x}" for x in missing]
        faults += [f"{name}: {x} is said to be there, and nothing declares it" for x in empty]
        faults += [f"{name}: {x} is said not to be there, and it is declared" for x in wrong]
    if not PAGE.exists() or PAGE.read_text() != page():
        faults.append(f"{PAGE.relative_to(TOP)} is not what scripts/compatibility.py makes; run it")
    for fault in faults:
        print(fault)
    return 1 if faults else 0


def print_missing():
    for section in SECTIONS:
        try:
            missing, _, _, done = compare(section)
        except Unavailable as reason:
            print(f"# {section.path.name}: {reason}")
            continue
        if missing or done:
            print(f"# {section.path.name}")
        for name in missing:
            print(f"{name}\t?\t")
        for name in done:
            print(f"# {name} is there now: its row says \"{SOON}\"")
    return 0


def main():
    parser = argparse.ArgumentParser(prog="compatibility.py", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="compare page, verdicts and declarations")
    parser.add_argument("--missing", action="store_true", help="print declared names without a row")
    args = parser.parse_args()
    if args.check:
        return check()
    if args.missing:
        return print_missing()
    PAGE.write_text(page())
    return 0


if __name__ == "__main__":
    sys.exit(main())
