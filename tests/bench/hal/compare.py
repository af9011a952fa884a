#!/usr/bin/env python3
"""HAL's figures, beside those of an installed LinuxCNC, in one table.

  compare.py [--build DIR] [--rounds N] [--only NAME]... [--list]

Every comparison runs both programs in turns and prints medians. Without LinuxCNC (/usr/bin/halrun) its column is '-'. A goal that is
missed is marked; the exit status tells only whether everything could be measured.

LinuxCNC has one HAL a machine: sessions take turns by the lock file /tmp/peer.lock.
"""
import contextlib
import fcntl
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import comparison  # noqa: E402

PEER = "/usr/bin/halrun"
TIME_LIMIT_S = 300


class Program:
    """Kerf's or LinuxCNC's halrun and halcmd."""

    def __init__(self, name, folder, env):
        self.name, self.folder = name, folder
        self.env = {**os.environ, **env}

    @contextlib.contextmanager
    def turn(self):
        yield

    def halrun(self, script, env=None):
        """Output of a script."""
        with tempfile.NamedTemporaryFile("w", suffix=".hal") as f, self.turn():
            os.chmod(f.name, 0o644)
            f.write(script)
            f.flush()
            run = subprocess.run([f"{self.folder}/halrun", "-f", f.name], capture_output=True, text=True, check=False,
                                 env={**self.env, **(env or {})}, timeout=TIME_LIMIT_S, stdin=subprocess.DEVNULL)
        if run.returncode != 0:
            raise RuntimeError(f"{self.name}: {run.stderr.strip()[:500]}")
        return run.stdout


class Peer(Program):
    def __init__(self):
        # As root it wants to know whom to be, and where its socket may stand.
        env = {"RTAPI_UID": "65534", "RTAPI_FIFO_PATH": "/tmp/rtapi_fifo_kerf_bench"} if os.geteuid() == 0 else {}
        super().__init__("LinuxCNC", "/usr/bin", env)

    def halrun(self, script, env=None):
        # The session before may not be gone yet though its turn is over.
        for _ in range(20):
            try:
                return super().halrun(script, env)
            except RuntimeError as e:
                if "already running" not in str(e):
                    raise
                time.sleep(1)
        return super().halrun(script, env)

    @contextlib.contextmanager
    def turn(self):
        with open("/tmp/peer.lock", "a", encoding="ascii") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            yield


def numbers(text):
    return [int(line) for line in text.split("\n") if re.fullmatch(r"-?\d+", line)]


def tick_ns(build):
    """LinuxCNC tells times in ticks of the processor's counter."""
    said = subprocess.run([f"{build}/bench/tick_rate"], capture_output=True, text=True, check=True).stdout
    return 1e9 / float(said)


def reads_us(build, count):
    """Time of so many reads of the processor's counter."""
    said = subprocess.run([f"{build}/bench/tick_rate", "--reads", str(count)], capture_output=True, text=True, check=True).stdout
    return float(said) / 1000


@contextlib.contextmanager
def on_one_processor():
    """The last one, where LinuxCNC puts its threads by itself."""
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {max(before)})
    yield
    os.sched_setaffinity(0, before)


# ---- scripts that both understand ---------------------------------------------------------------

def thread_script(functions, period_ns, samples=20):
    lines = [f"loadrt threads name1=t period1={period_ns}", f"loadrt and2 count={functions}"]
    lines += [f"addf and2.{i} t" for i in range(functions)]
    lines += ["start", "loadusr -w sleep 0.3"]
    for _ in range(samples):
        lines += ["loadusr -w sleep 0.01", "getp t.time"]
    return "\n".join(lines) + "\n"


def stamped(*parts):
    """A script whose parts are timed by the clock of the shell."""
    lines = []
    for part in parts:
        lines += ["loadusr -w date +%s%N", part]
    return "\n".join(lines + ["loadusr -w date +%s%N"]) + "\n"


def nets(components, first=0):
    """Two lines a component: its output to the next one's first input, and a second signal."""
    lines = []
    for i in range(first, components):
        lines.append(f"net a{i} and2.{i}.out and2.{(i + 1) % components}.in0")
        lines.append(f"net b{i} and2.{i}.in1")
    return "\n".join(lines)


# ---- measurements -------------------------------------------------------------------------------

class Bench:
    def __init__(self, build, rounds):
        self.build, self.rounds = build, rounds
        self.own = Program("Kerf", f"{build}/bin", {"KERF_INSTANCE": f"bench{os.getpid()}"})
        self.peer = Peer() if os.access(PEER, os.X_OK) else None

    def programs(self):
        return [p for p in (self.own, self.peer) if p]

    def row(self, what, own, peer, goal=None, unit="us", ratio=None):
        """`goal`: largest allowed ratio own/peer. `ratio`: where it is better known than from the two medians."""
        if ratio is None and peer:
            ratio = own / peer
        comparison.row(what, f"{own:.4g} {unit}", f"{peer:.4g} {unit}" if peer else "-", "-" if ratio is None else f"{ratio:.2f}",
                       "" if goal is None else f"<= {goal}", "" if goal is None or ratio is None else ratio <= goal)

    def thread_cycle(self):
        """Time of one cycle of 1000 and2, in pairs on one processor."""
        with on_one_processor():
            self.thread_cycles()

    def thread_cycles(self):
        ns = tick_ns(self.build) if self.peer else 0
        for period_ns in (1_000_000, 10_000_000):
            ms = period_ns // 1_000_000
            script = thread_script(1000, period_ns)
            for mode, what, goal in (("every", "all timed", 0.75), ("sampled", "sampled", 0.40)):
                own, peer, reads = [], [], []
                for n in range(2 * self.rounds):
                    turns = [lambda: own.append(statistics.median(numbers(self.own.halrun(script, {"KERF_FUNCTION_TIMING": mode}))) / 1000)]
                    if self.peer:
                        turns.append(lambda: peer.append(statistics.median(numbers(self.peer.halrun(script))) * ns / 1000))
                    for turn in reversed(turns) if n % 2 else turns:
                        turn()
                    if mode == "every":
                        reads.append(reads_us(self.build, 1000))
                # Of each pair its own ratio: what else the computer does changes from pair to pair more than within one.
                of_pairs = lambda times: statistics.median(t / p for t, p in zip(times, peer)) if peer else None
                med = lambda times: statistics.median(times) if times else None
                self.row(f"cycle of 1000 and2 in {ms} ms, {what}", med(own), med(peer), goal, ratio=of_pairs(own))
                if reads:
                    # Below this no program comes that reads the clock after each function.
                    self.row("    1000 reads of the clock and nothing else", med(reads), med(peer), ratio=of_pairs(reads))

    def loading(self):
        """loadrt of 1000 and2, then 2000 nets."""
        script = stamped("loadrt and2 count=1000", nets(1000))
        load, link = {}, {}
        for _ in range(self.rounds):
            for p in self.programs():
                t = numbers(p.halrun(script))
                load.setdefault(p.name, []).append((t[1] - t[0]) / 1e6)
                link.setdefault(p.name, []).append((t[2] - t[1]) / 1e6)
        med = lambda d, p: statistics.median(d[p.name]) if p else None
        self.row("loadrt and2 count=1000", med(load, self.own), med(load, self.peer), 1.0, "ms")
        self.row("2000 net lines at 1000 components", med(link, self.own), med(link, self.peer), 0.2, "ms")

    def growth(self):
        """net lines: twice as many."""
        own = {}
        for _ in range(max(self.rounds, 3)):
            for n in (500, 1000, 2000, 4000):
                t = numbers(self.own.halrun(stamped(f"loadrt and2 count={n}", nets(n))))
                own.setdefault(n, []).append((t[2] - t[1]) / 1e6)
        for n in (500, 1000, 2000, 4000):
            self.row(f"one of {2 * n} net lines at {n} components", statistics.median(own[n]) * 1000 / (2 * n), None)
        for n in (1000, 2000, 4000):
            ratio = min(own[n]) / min(own[n // 2])  # the least is the work itself, without what else ran
            comparison.row(f"time of {2 * n} nets over that of {n}", f"{ratio:.2f}", goal="<= 2.3", verdict=ratio <= 2.3)

    def large(self):
        """10 000 components, 20 000 nets, all in a thread."""
        loads = "\n".join(f"loadrt {c} count=2500" for c in ("and2", "or2", "xor2", "not"))
        pins = [(c, "in" if c == "not" else "in0") for c in ("and2", "or2", "xor2", "not")]
        net = "\n".join(f"net s{c}{i} {c}.{i}.out\nnet i{c}{i} {c}.{i}.{pin}" for c, pin in pins for i in range(2500))
        addf = "\n".join(f"addf {c}.{i} t" for c, _ in pins for i in range(2500))
        t = numbers(self.own.halrun(stamped("loadrt threads name1=t period1=10000000", loads, net, addf)))
        self.row("loadrt of 10 000 components", (t[2] - t[1]) / 1e6, None, unit="ms")
        self.row("20 000 net lines", (t[3] - t[2]) / 1e6, None, unit="ms")
        self.row("10 000 addf lines", (t[4] - t[3]) / 1e6, None, unit="ms")

    def getp(self):
        """A cold halcmd, beside a running HAL."""
        times = {}
        count = 40
        for _ in range(self.rounds):
            for p in self.programs():
                loop = f"for i in $(seq {count}); do {p.folder}/halcmd getp and2.500.out >/dev/null; done"
                with tempfile.NamedTemporaryFile("w", suffix=".sh") as f:
                    f.write(loop)
                    f.flush()
                    os.chmod(f.name, 0o644)
                    t = numbers(p.halrun(stamped("loadrt and2 count=1000", f"loadusr -w bash {f.name}")))
                times.setdefault(p.name, []).append((t[2] - t[1]) / 1e6 / count)
        peer = statistics.median(times[self.peer.name]) if self.peer else None
        self.row("getp by a cold halcmd", statistics.median(times[self.own.name]), peer, 1.0, "ms")

    def wake_up(self):
        """A 1 ms thread beside cyclictest at the same priority."""
        if not shutil.which("cyclictest"):
            print("wake-up of a 1 ms thread: no cyclictest (scripts/setup rtvm)")
            return
        script = ("loadrt threads name1=t period1=1000000\nloadrt and2 count=20\n" + "\n".join(f"addf and2.{i} t" for i in range(20)) +
                  "\nstart\nloadusr -w sleep 0.5\ntiming reset\nloadusr -w sleep 2\ntiming t\n")
        own, other = [], []
        for _ in range(max(self.rounds, 3)):
            said = subprocess.run(["cyclictest", "-q", "-m", "-p", "80", "-t", "1", "-i", "1000", "-l", "2000", "-h", "2000"],
                                  capture_output=True, text=True, check=False).stdout
            bins = [(int(us), int(n)) for us, n in re.findall(r"^(\d{6}) (\d+)$", said, re.M)]
            if not bins:
                print("wake-up of a 1 ms thread: cyclictest may not run here (needs rtprio)")
                return
            left = sum(n for _, n in bins) / 2
            for us, n in bins:
                left -= n
                if left <= 0:
                    other.append(us + (left + n) / n)  # within the bin
                    break
            row = re.search(r"^t +\(wake-up\) +\d+ +(\d+)", self.own.halrun(script), re.M)
            own.append(int(row.group(1)) / 1000)
        self.row("wake-up of a 1 ms thread, p50; cyclictest", statistics.median(own), statistics.median(other), 1.1)

    MEASUREMENTS = ("thread_cycle", "loading", "growth", "large", "getp", "wake_up")


def main():
    a = comparison.options(__doc__, Bench.MEASUREMENTS, rounds=3).parse_args()
    if comparison.listed(a, Bench):
        return 0
    return comparison.run(Bench(os.path.realpath(a.build), a.rounds), a.only)


if __name__ == "__main__":
    sys.exit(main())
