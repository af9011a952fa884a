#!/usr/bin/env python3
"""The interpreter's figures, beside those of an installed LinuxCNC, in one table.

  compare.py [--build DIR] [--rounds N] [--scale F] [--only NAME]... [--list]

Programs are generated; both rs274 run each in turns with the text going to /dev/null, and medians of the pairs are printed. Times are
those of the processor (user and system), which other work on the computer disturbs least; --wall takes those of the clock. Without
LinuxCNC (/usr/bin/rs274) its column is '-'. A goal that is missed is marked; the exit status tells only whether everything could be
measured. --scale makes the programs shorter or longer.
"""
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]
import comparison  # noqa: E402
import programs  # noqa: E402

PEER = "/usr/bin/rs274"
TIME_LIMIT_S = 600


class Bench:
    def __init__(self, args, folder):
        self.own, self.folder, self.args = f"{os.path.realpath(args.build)}/bin/rs274", folder, args
        self.null_bench = f"{os.path.realpath(args.build)}/bench/interp_bench"
        self.peer = PEER if os.access(PEER, os.X_OK) else None

    def run(self, program, path):
        """Seconds and kilobytes of one run."""
        begin = time.monotonic()
        child = subprocess.Popen([program, "-g", path], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode != 0:
            raise RuntimeError(f"{program} ended with {child.returncode} at {path}")
        wall = time.monotonic() - begin
        return (wall if self.args.wall else usage.ru_utime + usage.ru_stime), usage.ru_maxrss

    def program(self, make, count):
        path = f"{self.folder}/{make.__name__}-{count}.ngc"
        return path, make(path, count)

    def pair(self, what, make, count, goal, least):
        path, lines = self.program(make, max(int(count * self.args.scale), 5000))
        own, peer = [], []
        for _ in range(self.args.rounds):
            own.append(self.run(self.own, path)[0])
            if self.peer:
                peer.append(self.run(self.peer, path)[0])
        os.unlink(path)
        speed = lambda times: f"{lines / statistics.median(times) / 1000:.0f} k/s"
        if not peer:
            comparison.row(what, speed(own))
            return
        ratio = statistics.median(p / o for o, p in zip(own, peer))
        comparison.row(what, speed(own), speed(peer), f"{ratio:.1f}", f">= {goal}" + (f" ({least})" if least < goal else ""), ratio >= least)

    def speed(self):
        """Executed lines a second of four kinds of program, with text."""
        self.pair("(a) short G1 lines", programs.lines, 1_000_000, 8, 6)
        self.pair("(b) arcs and helices", programs.arcs, 200_000, 8, 6)
        self.pair("(c) loops with expressions", programs.loops, 2_000_000, 8, 8)
        self.pair("(d) sub calls with arguments", programs.calls, 100_000, 8, 8)

    def without_text(self):
        """G1 lines into a canon that drops all (interp_bench)."""
        said = subprocess.run([self.null_bench, "--benchmark_filter=straight_lines", f"--benchmark_repetitions={max(self.args.rounds, 3)}"],
                              capture_output=True, text=True, check=True, timeout=TIME_LIMIT_S).stdout
        found = re.search(r"straight_lines_median.*lines=([\d.]+)M/s", said)
        million = float(found.group(1))
        comparison.row("(a) without text", f"{million:.2f} M/s", goal=">= 3 M/s", verdict=million >= 3)

    def memory(self):
        """Largest resident size."""
        for what, make, count in (("5 000 000 G1 lines", programs.lines, 5_000_000), ("10 000 subs", programs.many_subs, 10_000)):
            path, _ = self.program(make, count)
            kilobytes = self.run(self.own, path)[1]
            comparison.row(f"memory, {what}", f"{kilobytes / 1024:.1f} MB", goal="< 64 MB", verdict=kilobytes < 64 * 1024)
            if make is programs.lines:
                self.first_call(path, count)
            os.unlink(path)

    def first_call(self, path, count):
        times = []
        for _ in range(self.args.rounds):
            begin = time.monotonic()
            with subprocess.Popen([self.own, "-g", path], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as child:
                child.stdout.read(1)
                times.append((time.monotonic() - begin) * 1000)
                child.kill()
        comparison.row(f"first call, {count} lines", f"{statistics.median(times):.1f} ms", goal="< 50 ms", verdict=statistics.median(times) < 50)

    def growth(self):
        """Time of a line when there is ten times and a hundred times as much of something."""
        for what, make, counts in (("lines of the file", programs.lines, (200_000, 2_000_000)), ("subs", programs.many_subs, (10, 1000)),
                                   ("named parameters", programs.many_parameters, (10, 1000))):
            times = []
            for count in counts:
                path, lines = self.program(make, count)
                times.append(min(self.run(self.own, path)[0] for _ in range(max(self.args.rounds, 3))) / lines * 1e9)
                os.unlink(path)
            comparison.row(f"a line at {counts[0]}, at {counts[1]} {what}", f"{times[0]:.0f} ns", f"{times[1]:.0f} ns",
                     f"{times[1] / times[0]:.2f}", "<= 1.3", times[1] / times[0] <= 1.3)

    MEASUREMENTS = ("speed", "without_text", "memory", "growth")


def main():
    ap = comparison.options(__doc__, Bench.MEASUREMENTS, rounds=5)
    ap.add_argument("--scale", type=float, default=1)
    ap.add_argument("--wall", action="store_true")
    a = ap.parse_args()
    if comparison.listed(a, Bench):
        return 0
    with tempfile.TemporaryDirectory(prefix="kerf-bench-") as folder:
        return comparison.run(Bench(a, folder), a.only)


if __name__ == "__main__":
    sys.exit(main())
