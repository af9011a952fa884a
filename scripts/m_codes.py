#!/usr/bin/env python3
"""scripts/m_codes.py: makes docs/m-codes.md.

What the page says of a code is what tests/seeds/002.tsv says and tests prove: each sentence is a row with its test. Names and forms of the
codes stand in docs/m-codes/codes.tsv, in the page's order; the examples are nc_files/examples/m-codes/SECTION.ngc, which
tests/machine runs.

  scripts/m_codes.py            write docs/m-codes.md
  scripts/m_codes.py --check    exit 1 when the page is not what would be written, or a code, an example or a row is missing
"""
import argparse
import re
import sys
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent
PAGE = TOP / "docs/m-codes.md"
CODES = TOP / "docs/m-codes/codes.tsv"
ROWS = TOP / "tests/seeds/002.tsv"
EXAMPLES = TOP / "nc_files/examples/m-codes"

HEAD = """# M-codes

Made by `scripts/m_codes.py` from the rows of `tests/seeds/002.tsv`: every sentence here has a test. The examples are in
`nc_files/examples/m-codes` and run in CI on the simulated mill; `;` lines at their end say what the pins did. `[RS274NGC]COMPAT = 2.7` or
`2.8` selects what older manuals say (see [configuration](configuration.md)). Where Kerf and LinuxCNC differ:
[differences](differences.md).
"""

# The first that matches says where a row goes; the rest is what the code does.
KINDS = [
    ("Errors", re.compile(r"\berror\b|\bis refused|^Unknown M-code|\bfails M19\b|\baborts the cycle\b", re.I)),
    ("Pins", re.compile(r"\b(iocontrol\.0|spindle\.N|motion|parport\.0)\.[a-z]|\bpins?\b", re.I)),
    ("Timing", re.compile(r"\bat once\b|\bin step with\b|\bqueued\b|\bwaits?\b|time-out|\bseconds\b|\bbreak blending\b|\bbreaks blending\b|"
                          r"\bnext (move|motion|line)\b|\bwhen motion receives\b|\bmotion command\b|\bholds the\b", re.I)),
    ("Words", re.compile(r"^(P|Q|R|L|E|T|S)\d?\b|\b(P|Q|R|L|E)\d? (may|is|runs|outside|are)\b|\$|\btakes [A-Z]\b|^The T word|^Without \$", re.I)),
]
ORDER = ["Words", "Does", "Pins", "Timing", "Errors"]


def table(path):
    lines = path.read_text(encoding="utf-8").splitlines()
    names = lines[0].split("\t")
    return [dict(zip(names, line.split("\t"))) for line in lines[1:] if line]


def kind_of(gist):
    return next((name for name, pattern in KINDS if pattern.search(gist)), "Does")


def page(complain):
    rows = {}
    for row in table(ROWS):
        section = row["id"].split("-")[1]
        if row["test"] == "later":
            complain(f"{row['id']} has no test")
        if row["test"] not in ("no behaviour", "later"):
            rows.setdefault(section, []).append(row["gist"])
    codes = table(CODES)
    known = {code["section"] for code in codes}
    for section in rows:
        if re.fullmatch(r"m\d+", section) and section not in known:
            complain(f"docs/m-codes/codes.tsv has no section {section}, and {ROWS.name} has")
    out = [HEAD, "| code | | |", "|---|---|---|"]
    for code in codes:
        out.append(f"| [{code['codes']}](#{code['section']}) | {code['title']} | `{code['form']}` |")
    for code in codes:
        section = code["section"]
        out += ["", f"<a id=\"{section}\"></a>", "", f"## {code['codes']}: {code['title']}", "", f"`{code['form']}`"]
        by_kind = {}
        for gist in rows.get(section, []):
            by_kind.setdefault(kind_of(gist), []).append(gist)
        if not by_kind:
            complain(f"{section}: {ROWS.name} has no row with a test")
        for kind in ORDER:
            if kind in by_kind:
                out += ["", f"{kind}:", ""] + [f"* {gist}." for gist in by_kind[kind]]
        example = EXAMPLES / f"{section}.ngc"
        if not example.is_file():
            complain(f"{example.relative_to(TOP)} is not there")
            continue
        out += ["", "```", example.read_text(encoding="utf-8").rstrip(), "```"]
    for stray in sorted(EXAMPLES.glob("*.ngc")):
        if stray.stem not in known:
            complain(f"{stray.relative_to(TOP)} belongs to no section of docs/m-codes/codes.tsv")
    return "\n".join(out) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true")
    check = parser.parse_args().check
    problems = []
    text = page(problems.append)
    if check and (not PAGE.is_file() or PAGE.read_text(encoding="utf-8") != text):
        problems.append(f"{PAGE.relative_to(TOP)} is stale: run scripts/m_codes.py")
    if not check:
        PAGE.write_text(text, encoding="utf-8")
    for problem in problems:
        print(problem, file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
