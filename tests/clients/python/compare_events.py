#!/usr/bin/env python3
"""compare_events.py LINUXCNC.log KERF.log [--listed listed_differences.tsv] [--draft]

Compares two event logs of every_member.py, call by call and member by member. What differs must stand in the list with its
reason; prints what does not, and `N lines same, M listed differences, U unexplained`. Exit status 1 when U is not 0.
--draft prints the rows that the list lacks, without reasons.

A row of the list: CALL <tab> MEMBER <tab> LINUXCNC <tab> KERF <tab> REASON. The first four are regular expressions of the whole
text; `-` as a value is "nothing in the log", which for a member of stat means that the call did not change it.
"""
import argparse
import pathlib
import re
import sys

NOTHING = "-"


def events(path):
    """[(call, {member: value})]; how the call ended is its member `ended`."""
    out = []
    for line in pathlib.Path(path).read_text().splitlines():
        if not line.startswith("    "):
            call, arrow, result = line.partition(" -> ")
            if not arrow:
                call, arrow, result = line.partition(" = ")
            out.append((call, {"ended": result} if arrow else {}))
            continue
        member, equals, value = line.strip().partition(" = ")
        if not equals:
            member, equals, value = line.strip().partition(" ")
        members = out[-1][1]
        name, count = member, 1
        while name in members:
            count += 1
            name = f"{member} {count}"
        members[name] = value
    return out


def rules_of(path):
    rules = []
    for number, line in enumerate(pathlib.Path(path).read_text().splitlines(), 1):
        if not line.strip() or line.startswith("#"):
            continue
        fields = line.split("\t")
        if len(fields) != 5 or not fields[4].strip():
            sys.exit(f"{path}:{number}: expected CALL, MEMBER, LINUXCNC, KERF and REASON with tabs between")
        rules.append((number, [re.compile(field, re.DOTALL) for field in fields[:4]]))
    return rules


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("linuxcnc")
    parser.add_argument("kerf")
    parser.add_argument("--listed", default=pathlib.Path(__file__).with_name("listed_differences.tsv"))
    parser.add_argument("--draft", action="store_true")
    options = parser.parse_args()
    rules = rules_of(options.listed)
    theirs, ours = events(options.linuxcnc), events(options.kerf)
    calls = [[call for call, _ in log] for log in (theirs, ours)]
    # A call that only one of the two logged stands beside nothing.
    if calls[0] != calls[1]:
        both = set(calls[0]) & set(calls[1])
        only = [(call, {**members, "logged": "yes"}) for log in (theirs, ours) for call, members in log if call not in both]
        pairs = [(call, members, {}) if (call in calls[0]) else (call, {}, members) for call, members in only]
        left, right = ([event for event in log if event[0] in both] for log in (theirs, ours))
        if [call for call, _ in left] != [call for call, _ in right]:
            print("the two logs have their calls in another order")
            return 1
    else:
        pairs, left, right = [], theirs, ours
    pairs = [(call, a, b) for (call, a), (_, b) in zip(left, right)] + pairs
    same = listed = unexplained = 0
    used = set()
    for call, a, b in pairs:
        same += 1
        for member in dict.fromkeys([*a, *b]):
            texts = [call, member, a.get(member, NOTHING), b.get(member, NOTHING)]
            if texts[2] == texts[3]:
                same += 1
                continue
            rule = next((number for number, patterns in rules if all(p.fullmatch(t) for p, t in zip(patterns, texts))), None)
            if rule is not None:
                listed += 1
                used.add(rule)
                continue
            unexplained += 1
            if options.draft:
                print("\t".join(re.escape(text).replace(r"\ ", " ") for text in texts))
            else:
                print(f"{call}: {member}\n    LinuxCNC: {texts[2]}\n    Kerf:     {texts[3]}")
    for number, _ in rules:
        if number not in used:
            print(f"{options.listed}:{number}: not seen this time")
    print(f"{same} lines same, {listed} listed differences, {unexplained} unexplained")
    return 1 if unexplained else 0


if __name__ == "__main__":
    sys.exit(main())
