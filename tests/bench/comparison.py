"""What the programs that measure Kerf beside LinuxCNC share: options and the table."""
import argparse
import pathlib
import subprocess
import sys

TOP = pathlib.Path(__file__).resolve().parents[2]
WIDTHS = (52, 14, 14, 7, 12, 7)


def row(what, own, peer="-", ratio="-", goal="", verdict=""):
    """One line. `verdict`: text, or True and False for a goal that is met or not."""
    verdict = {True: "ok", False: "MISSED"}.get(verdict, verdict)
    print("  ".join(f"{c:>{w}}" for c, w in zip((what, own, peer, ratio, goal, verdict), WIDTHS)), flush=True)


def options(doc, measurements, rounds):
    ap = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("--build", default=str(TOP / "build/release"))
    ap.add_argument("--rounds", type=int, default=rounds)
    ap.add_argument("--only", action="append", choices=measurements)
    ap.add_argument("--list", action="store_true")
    return ap


def listed(args, bench_class):
    """True when only a list was wanted, which is printed."""
    if args.list:
        for name in bench_class.MEASUREMENTS:
            print(f"{name:<14} {getattr(bench_class, name).__doc__}")
    return args.list


def run(bench, only):
    """All measurements, or those that are named. The exit status."""
    row("", "Kerf", "LinuxCNC", "ratio", "goal")
    status = 0
    for name in only or bench.MEASUREMENTS:
        try:
            getattr(bench, name)()
        except (OSError, RuntimeError, subprocess.SubprocessError, IndexError, AttributeError) as e:
            print(f"{name}: {e}", file=sys.stderr)
            status = 1
    return status
