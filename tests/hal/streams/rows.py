"""make: writes rows.tmp, random rows of every type, the same each time, as halsampler prints them.
compare: samples.tmp must be the same. Removes both."""
import os
import random
import sys

ROWS, SAMPLES = "rows.tmp", "samples.tmp"


def make():
    rng = random.Random(3)
    with open(ROWS, "w", encoding="ascii") as out:
        out.write("# every type\n")
        out.write(f"1 -0.000000 {-2**31} {2**32 - 1} {-2**63} {2**64 - 1} \n")
        for _ in range(299):
            out.write(f"{rng.getrandbits(1)} {rng.randint(-10**9, 10**9) / 1000:f} {rng.randint(-2**31, 2**31 - 1)} "
                      f"{rng.getrandbits(32)} {rng.randint(-2**63, 2**63 - 1)} {rng.getrandbits(64)} \n")


def compare():
    with open(ROWS, encoding="ascii") as rows, open(SAMPLES, encoding="ascii") as samples:
        expected, seen = rows.readlines()[1:], samples.readlines()
    os.remove(ROWS)
    os.remove(SAMPLES)
    for number, (want, got) in enumerate(zip(expected, seen)):
        if want != got:
            sys.exit(f"row {number}: {got!r} instead of {want!r}")
    if len(expected) != len(seen):
        sys.exit(f"{len(seen)} rows instead of {len(expected)}")
    print(f"{len(seen)} rows are the same")


make() if sys.argv[1] == "make" else compare()
