#!/usr/bin/env python3
"""scripts/ini_keys.py: writes the table of INI keys into docs/configuration.md and docs/compatibility/ini.tsv.

The table itself is src/ini/keys/; `kerf keys --tsv` of the built tree (build/dev, or $KERF_BUILD_DIR) prints it.

  scripts/ini_keys.py            write both, then scripts/compatibility.py
  scripts/ini_keys.py --check    exit 1 if they are not what the table says
"""

import argparse
import os
import subprocess
import sys
from pathlib import Path

TOP = Path(__file__).resolve().parents[1]
PAGE = TOP / "docs/configuration.md"
VERDICTS = TOP / "docs/compatibility/ini.tsv"
BEGIN, END = "<!-- keys: made by scripts/ini_keys.py -->\n", "<!-- end of keys -->\n"
BUILD = Path(os.environ.get("KERF_BUILD_DIR", TOP / "build/dev")).resolve()
ANCHORS = {"see HAL files": "[HAL files](#hal-files)", "see Two passes": "[Two passes](#two-passes)",
           "see Remapped codes": "[Remapped codes](#remapped-codes)"}
SHOWN = {"AXIS_L": "AXIS_X .. AXIS_W", "JOINT_n": "JOINT_0 ..", "SPINDLE_n": "SPINDLE_0 .."}


def read_table():
    """[(section, meaning, [row as dict])]"""
    kerf = BUILD / "bin/kerf"
    if not kerf.exists():
        sys.exit(f"ini_keys.py: {kerf} is not there; build it: scripts/build dev -t kerf")
    text = subprocess.run([kerf, "keys", "--tsv"], capture_output=True, text=True, check=True).stdout
    header, *lines = text.splitlines()
    names, sections = header.split("\t"), []
    for line in lines:
        words = line.split("\t")
        if words[0].startswith("# "):
            sections.append((words[0][2:], words[1], []))
        else:
            sections[-1][2].append(dict(zip(names, words)))
    return sections


def cell(text):
    for words, link in ANCHORS.items():
        text = text.replace(words, "see " + link)
    # What looks like a tag or a table's border must not become one.
    return text.replace("|", r"\|").replace("#<", r"\#&lt;")


def value_cell(row):
    out = row["type"] + (f" [{row['unit']}]" if row["unit"] else "")
    return out + (f", {row['need']}" if row["need"] else "")


def meaning_cell(row):
    note = row["note"]
    if row["verdict"] == "no":
        note = f"*Not supported:* {note}"
    return cell("; ".join(t for t in (row["meaning"], note) if t))


def page_part(sections):
    out = []
    for section, meaning, rows in sections:
        out += [f"### [{SHOWN.get(section, section)}]", ""]
        if meaning:
            out += [meaning[0].upper() + meaning[1:] + ".", ""]
        out += ["| key | value | default | read by | meaning |", "|---|---|---|---|---|"]
        out += [f"| {row['key']} | {cell(value_cell(row))} | {cell(row['default'])} | {row['by'] or '-'} | {meaning_cell(row)} |"
                for row in rows]
        out.append("")
    return "\n".join(out)


def verdict_file(sections):
    out = ["# Made by scripts/ini_keys.py from the table of keys in src/ini/keys; do not edit."]
    for section, _, rows in sections:
        out.append(f"## [{section}]")
        for row in rows:
            verdict, note = row["verdict"], row["note"]
            if verdict == "own":
                verdict, note = "works", "Kerf only"
            elif verdict == "works" and row["by"] in ("screen", "HAL files", "halui"):
                note = f"read by {'the screen' if row['by'] == 'screen' else row['by']}"
            out.append(f"[{section}]{row['key']}\t{verdict}" + (f"\t{note}" if note else ""))
    return "\n".join(out) + "\n"


def main():
    parser = argparse.ArgumentParser(prog="ini_keys.py", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="compare instead of writing")
    args = parser.parse_args()
    sections = read_table()
    text = PAGE.read_text()
    if BEGIN not in text or END not in text:
        sys.exit(f"ini_keys.py: {PAGE} lacks the lines {BEGIN!r} and {END!r}")
    page = text[:text.index(BEGIN) + len(BEGIN)] + "\n" + page_part(sections) + text[text.index(END):]
    wanted = {PAGE: page, VERDICTS: verdict_file(sections)}
    if args.check:
        stale = [str(p.relative_to(TOP)) for p, t in wanted.items() if not p.exists() or p.read_text() != t]
        for name in stale:
            print(f"{name} is not what the table of keys says; run scripts/ini_keys.py")
        return 1 if stale else 0
    for path, content in wanted.items():
        path.write_text(content)
    return subprocess.run([TOP / "scripts/compatibility.py"], check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
