#!/usr/bin/env python3
"""Says which behaviour sentences of the seed documents have a test, and which have none.

tests/seeds/NNN.tsv has one row per sentence, edge.tsv one per edge case that users of other controls have met, with the
tab-separated columns
  id    seed, section and number, such as 002-m66-07; never reused
  gist  what the sentence asks for, in our words
  test  later               no test yet
        no behaviour        advice or navigation: nothing to test
        same as ID          another row says the same; its test counts
        Suite.Name          a GoogleTest (TEST, TEST_F, TEST_P, TYPED_TEST) in tests/
        some/directory      a golden or case directory, from tests/ or the repository
        several tests are separated by commas
  note  free text

Seeds 000, 001 and 002 are the M-code manuals: each row of theirs has a test or is no behaviour. The test programs and scripts that
the rows name carry the label `seeds`; `scripts/test -L seeds` runs them and ends with the count (--closing).

Exit: 0 all fine, 1 a repeated id, a broken row or a test that does not exist, or with --closing a row that is left.
"""

import argparse
import re
import signal
import sys
from collections import Counter
from pathlib import Path

COLUMNS = ["id", "gist", "test", "note"]
ID = re.compile(r"^(\d{3}|edge)-[a-z0-9_]+-\d{2,3}$")
GTEST = re.compile(r"\b(?:TEST|TEST_F|TEST_P|TYPED_TEST|TYPED_TEST_P)\s*\(\s*(\w+)\s*,\s*(\w+)\s*\)")
GTEST_NAME = re.compile(r"^(?:\w+/)?(\w+)(?:/\d+)?\.(\w+)(?:/\w+)?$")
SAME = "same as "
CLOSED = ("000", "001", "002")


class Row:
    def __init__(self, place, values):
        self.place = place
        self.id, self.gist, self.test, self.note = values


def read_rows(paths, complain):
    """The rows of all files by id, in file order."""
    rows = {}
    for path in paths:
        lines = path.read_text(encoding="utf-8").splitlines()
        if not lines or lines[0].split("\t") != COLUMNS:
            complain(f"{path}:1: expected the columns {' '.join(COLUMNS)}, separated by tabs")
            continue
        for number, line in enumerate(lines[1:], 2):
            place = f"{path}:{number}"
            values = line.split("\t")
            if len(values) != len(COLUMNS):
                complain(f"{place}: expected {len(COLUMNS)} columns, found {len(values)}")
                continue
            row = Row(place, values)
            match = ID.match(row.id)
            if not match or match.group(1) != path.stem:
                complain(f"{place}: id '{row.id}': expected {path.stem}-SECTION-NN")
            elif row.id in rows:
                complain(f"{place}: id {row.id} is already used at {rows[row.id].place}")
            elif not row.gist or not row.test:
                complain(f"{place}: {row.id}: gist and test may not be empty")
            else:
                rows[row.id] = row
    return rows


def google_tests(tests):
    """Every Suite.Name that a source file under tests/ defines, with its file."""
    names = {}
    for path in sorted(tests.rglob("*")):
        if path.suffix in {".cpp", ".cc", ".hpp"} and path.is_file():
            text = path.read_text(encoding="utf-8", errors="replace")
            names.update({f"{suite}.{name}": path for suite, name in GTEST.findall(text)})
    return names


def resolve(row, rows, complain):
    """The row whose test counts for `row`: itself, or the end of its `same as` chain."""
    seen = set()
    while row.test.startswith(SAME):
        target = row.test[len(SAME):].strip()
        if row.id in seen or target not in rows:
            why = "in a circle" if row.id in seen else "which does not exist"
            complain(f"{row.place}: {row.id}: same as {target}, {why}")
            return None
        seen.add(row.id)
        row = rows[target]
    return row


def check_test(row, root, known, complain):
    """The source files and case directories of the tests that `row` names."""
    places = []
    for name in (part.strip() for part in row.test.split(",")):
        match = GTEST_NAME.match(name)
        test = f"{match.group(1)}.{match.group(2)}" if match else ""
        folder = next((base / name for base in (root / "tests", root) if "/" in name and (base / name).is_dir()), None)
        if test in known:
            places.append(known[test])
        elif folder:
            places.append(folder)
        else:
            complain(f"{row.place}: {row.id}: no test or case directory '{name}'")
    return places


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--missing", action="store_true", 
                        help="list the rows without a test (not those that are `same as` another)")
    parser.add_argument("--seed", metavar="NNN", help="only list this seed's missing rows")
    parser.add_argument("--closing", action="store_true",
                        help=f"one line for the seeds {', '.join(CLOSED)} together: rows, tested, no behaviour, left")
    parser.add_argument("--places", action="store_true",
                        help="the source files and case directories that the rows of these seeds name (read by cmake/kerf.cmake)")
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parent.parent,
                        help="the repository (default: the one this script is in)")
    args = parser.parse_args()
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # `| head` is no error

    problems = []
    paths = sorted((args.root / "tests" / "seeds").glob("*.tsv"))
    if not paths:
        problems.append(f"{args.root}/tests/seeds: no .tsv files")
    rows = read_rows(paths, problems.append)
    known = google_tests(args.root / "tests")

    counts = {path.stem: Counter() for path in paths}
    missing = []
    places = set()
    for row in rows.values():
        target = resolve(row, rows, problems.append)
        if target is None:
            continue
        seed = row.id.split("-")[0]
        count = counts[seed]
        count["rows"] += 1
        if target.test == "no behaviour":
            count["none"] += 1
        elif target.test == "later":
            count["later"] += 1
            if not row.test.startswith(SAME):
                missing.append(row)
        else:
            count["tested"] += 1
            if target is row:
                found = check_test(row, args.root, known, problems.append)
                if seed in CLOSED:
                    places.update(found)

    if args.places:
        print(*sorted(places), sep="\n")
    elif args.closing:
        closed = sum((counts[seed] for seed in CLOSED if seed in counts), Counter())
        print(f"seeds {', '.join(CLOSED)}: {closed['rows']} rows: {closed['tested']} tested, {closed['none']} no behaviour, "
              f"{closed['later']} left")
        if closed["later"]:
            problems.append(f"{closed['later']} rows have no test; list them with scripts/seed_coverage.py --missing")
    elif args.missing:
        for row in missing:
            if args.seed in (None, row.id.split("-")[0]):
                print(f"{row.id}\t{row.gist}")
    else:
        print(f"{'seed':<6}{'rows':>6}{'tested':>8}{'later':>7}{'no behaviour':>14}{'tested %':>10}")
        for seed, count in [*counts.items(), ("all", sum(counts.values(), Counter()))]:
            testable = count["tested"] + count["later"]
            share = 100 * count["tested"] / testable if testable else 100
            print(f"{seed:<6}{count['rows']:>6}{count['tested']:>8}{count['later']:>7}"
                  f"{count['none']:>14}{share:>10.1f}")
    for problem in problems:
        print(problem, file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
