#!/usr/bin/python3
"""Makes the table of src/motion/core/path/junction_shapes.cpp: shapes of q'' with the least jerk where two curves meet.

Usage: junction_shapes.py [--count N]                    (Debian: python3-scipy)
       junction_shapes.py --least KINK JUMP P REACH     the least jerk of any curve: kink [rad], jump [1/mm], P and reach [mm], by 40 knots a side

A blend from -l to l has to lead from one curve to another: q' jumps by `kink` and q'' by `jump` at its middle. q'' is linear between knots at
shares of l, so jerk is the steepest slope. For a kink, a jump and an l the least jerk within the tolerance (1 here) is a linear program in the
values at the knots: an even function for the kink, an odd one for the jump. It is solved for many kinks, jumps and widths, from those at which the
tolerance is all that counts down to those with little room; then the N shapes are chosen which together are nearest to the best of each.
Prints the rows of the table, and how near to the best speed they are (speed is the cube root of jerk).
"""
import argparse
import sys

import numpy as np
from scipy.optimize import linprog

KNOTS = np.linspace(0, 1, 41) if "--least" in sys.argv else np.array([0, 0.2, 0.5, 0.8, 1.0])
LAST = len(KNOTS) - 1
STEPS = np.diff(KNOTS)
PLACES = np.linspace(0, 1, 21)[:-1]
FINE = np.linspace(0, 1, 2001)
HATS = [np.interp(FINE, KNOTS, row) for row in np.eye(LAST + 1)]


def offs(values):
    """Deviation at PLACES, from the integral of (t - x) f(t) from x to 1."""
    out = []
    for x in PLACES:
        t = np.linspace(x, 1, 1601)
        out.append(np.trapz((t - x) * np.interp(t, KNOTS, values), t))
    return np.array(out)


OFF = np.array([offs(row) for row in np.eye(LAST + 1)])
OFF_HALF = offs(np.full(LAST + 1, 0.5))
AREA = np.array([np.trapz(h, FINE) for h in HATS])
MOMENT = np.array([np.trapz(FINE * h, FINE) for h in HATS])
SIGNS = [(a, b) for a in (1, -1) for b in (1, -1)]


def solve(kink, jump, l):
    """The least jerk and (even at the first four knots, odd at the second to the fourth), or infinity."""
    rows, right = [], []

    def row(even, odd, last, bound):
        for a, b in SIGNS:
            rows.append(np.concatenate([a * even, b * odd[0], [last]]))
            right.append(bound - b * odd[1])

    for k in range(len(PLACES)):
        # Over |even| + |odd|, which is what the deviation comes to on one side of the vertex or the other.
        row(kink * l * OFF[:LAST, k],
            (jump * l * l * OFF[1:LAST, k], jump * l * l * (0.5 * OFF[LAST, k] - OFF_HALF[k])), 0.0, 1.0)
    for i in range(LAST):
        even, odd = np.zeros(LAST + 1), np.zeros(LAST + 1)
        even[i], even[i + 1], odd[i], odd[i + 1] = -1, 1, -1, 1
        constant = 0.5 * odd[LAST]
        row(even[:LAST] * kink / l**2 / STEPS[i], (odd[1:LAST] * jump / l / STEPS[i], constant * jump / l / STEPS[i]), -1.0, 0.0)
    size = 2 * LAST  # even at all knots but the last, odd at all but both ends, and the jerk
    equal = np.zeros((2, size))
    equal[0, :LAST], equal[1, LAST:-1] = AREA[:LAST], MOMENT[1:LAST]
    found = linprog(np.eye(size)[-1], A_ub=np.array(rows), b_ub=right, A_eq=equal, b_eq=[0.5, 0.25 - 0.5 * MOMENT[LAST]],
                    bounds=[(None, None)] * (size - 1) + [(0, None)], method="highs")
    return (found.fun, found.x[:-1]) if found.status == 0 else (np.inf, None)


def least_jerk(shape, kink, jump, reach):
    """Of a shape, at the largest l within reach at which it keeps the tolerance."""
    even, odd = np.append(shape[:4], 0), np.concatenate([[0], shape[4:7], [0.5]])
    c1, c2 = kink * np.abs(even @ OFF), jump * np.abs(odd @ OFF - OFF_HALF)
    root = c1 + np.sqrt(c1**2 + 4 * c2)
    l = min(reach, np.min(2 / np.maximum(root, 1e-12)))
    slopes = [np.abs(np.diff(f) / STEPS) for f in (even, odd)]
    return np.max(kink * slopes[0] / l**2 + jump * slopes[1] / l)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--count", type=int, default=40, help="rows of the table")
    parser.add_argument("--least", type=float, nargs=4, metavar=("KINK", "JUMP", "P", "REACH"), help="only the least jerk of one case")
    args = parser.parse_args()
    if args.least:
        kink, jump, p, reach = args.least
        print("%.4f" % (p * min(solve(kink / p, jump / p, reach * share)[0] for share in np.linspace(0.3, 1, 15))))
        return
    count = args.count
    cases = []
    for jump in [0, 0.03, 0.06, 0.12, 0.25, 0.5, 1, 2, 4, 8, 16, 32, 64, None]:
        kink, jump = (0, 1) if jump is None else (1, jump)
        best = min((solve(kink, jump, l)[0], l) for l in np.geomspace(0.3, 90, 110))[1]
        for share in (1, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2):
            cases.append((kink, jump, best * share, *solve(kink, jump, best * share)))
    shapes = [case[4] for case in cases]
    speed = np.array([[np.cbrt(jerk / least_jerk(s, kink, jump, l)) for s in shapes] for kink, jump, l, jerk, _ in cases])
    reached = np.zeros(len(cases))
    for _ in range(count):
        with_each = np.maximum(reached[:, None], speed)
        gain = (with_each - reached[:, None]).sum(0) + 5 * np.minimum(with_each, 0.99).sum(0)
        chosen = int(np.argmax(gain))
        reached = with_each[:, chosen]
        s = shapes[chosen]
        even, odd = (", ".join("%g" % round(x, 4) for x in part) for part in (s[:3], s[4:6]))
        print("    {{%s}, {%s}}," % (even, odd))
    print(f"// of the best speed: {reached.min():.3f} at worst, {reached.mean():.4f} in the mean, {len(cases)} cases")


if __name__ == "__main__":
    main()
