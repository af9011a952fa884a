"""What the small HAL programs share: they talk to HAL through halcmd, as a user at a shell does."""
import os
import pathlib
import signal
import subprocess
import sys
import tempfile

BIN = pathlib.Path(__file__).resolve().parent.parent / "bin"
ME = pathlib.Path(sys.argv[0]).name


class HalError(Exception):
    pass


def end(text, status=1):
    print(f"{ME}: {text}", file=sys.stderr)
    sys.exit(status)


def main(run):
    """Runs `run`, with one line for what goes wrong, and quiet at Ctrl-C and at the end of a pipe."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    try:
        sys.exit(run() or 0)
    except KeyboardInterrupt:
        sys.exit(0)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(0)
    except HalError as error:
        end(str(error))


def halcmd(*words, script=None):
    """What halcmd prints; its complaint is a HalError."""
    command = [str(BIN / "halcmd"), *map(str, words)]
    if script is not None:
        with tempfile.NamedTemporaryFile("w", suffix=".hal") as file:
            file.write(script)
            file.flush()
            done = subprocess.run(command + ["-f", file.name], capture_output=True, text=True, check=False)
            said = done.stderr.replace(file.name + ":", "line ")
    else:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        said = done.stderr.replace("<commandline>:0: ", "")
    if done.returncode != 0:
        raise HalError(" ".join(said.split("\n")).strip() or "halcmd failed")
    return done.stdout


class Item:
    """A pin, signal or parameter as `halcmd -s show` tells of it."""

    def __init__(self, kind, words):
        self.kind = kind
        if kind == "sig":
            self.type, self.value, self.name = words[0], words[1], words[2]
            self.dir, self.signal = "", ""
            # NAME <== WRITER ==> READER <=> BOTH
            marks = list(zip(words[3::2], words[4::2]))
            self.writers = [name for mark, name in marks if mark == "<=="]
            self.readers = [name for mark, name in marks if mark == "==>"]
            self.both = [name for mark, name in marks if mark == "<=>"]
        else:
            self.owner, self.type, self.dir, self.value, self.name = words[:5]
            self.signal = words[6] if len(words) > 6 else ""

    def read(self):
        return halcmd("gets" if self.kind == "sig" else "getp", self.name).strip()

    def write(self, value):
        """A pin on a signal is written through the signal."""
        if self.kind == "sig" or self.signal:
            halcmd("sets", self.signal or self.name, value)
        else:
            halcmd("setp", self.name, value)

    def refuses(self):
        """Why it cannot be written, or ""."""
        if self.kind == "param" and self.dir == "RO":
            return "it is a read-only parameter"
        if self.kind == "pin" and self.dir == "OUT":
            return "it is an output"
        signal = find(self.signal, ("sig",)) if self.signal else self if self.kind == "sig" else None
        if signal is not None and signal.writers:
            return f"{signal.writers[0]} writes its signal"
        return ""


def items(kind, pattern=None):
    out = []
    for line in halcmd("-s", "show", kind, *([pattern] if pattern else [])).split("\n"):
        words = line.split()
        if len(words) >= 3:
            out.append(Item(kind, words))
    return out


def find(name, kinds=("pin", "param", "sig")):
    """The item of exactly this name, or None."""
    for kind in kinds:
        for item in items(kind, name):
            if item.name == name:
                return item
    return None


def need(name, kinds=("pin", "param", "sig")):
    item = find(name, kinds)
    if item is None:
        what = {"pin": "pin", "param": "parameter", "sig": "signal"}
        raise HalError(f"{' or '.join(what[kind] for kind in kinds)} '{name}' not found; `halcmd show` lists what there is")
    return item


def bars(rows, width=50):
    """Lines of a histogram of (label, count)."""
    most = max((count for _, count in rows), default=0)
    label = max((len(text) for text, _ in rows), default=0)
    return [f"{text:>{label}} {count:>9.0f} {'#' * (round(count / most * width) if most else 0)}".rstrip() for text, count in rows]


def time_ns(text):
    """25000, 25us, 1ms, 1s: nanoseconds. A number below 1000 without a unit is microseconds."""
    for unit, factor in (("ns", 1), ("us", 1000), ("\u00b5s", 1000), ("\u03bcs", 1000), ("ms", 1000000), ("s", 1000000000)):
        if text.endswith(unit):
            number = text[:-len(unit)]
            break
    else:
        number, factor = text, 1
    try:
        value = round(float(number) * factor)
        if number == text and value < 1000:
            value = round(float(number) * 1000)
    except ValueError:
        value = 0
    if value <= 0:
        raise HalError(f"'{text}' is no time; write nanoseconds, or 25us, 1ms")
    return value


class OwnHal:
    """A HAL of the program's own, for measurements: it does not meet the one of a running machine."""

    def __init__(self, virtual=False):
        instance = f"{ME}-{os.getpid()}".replace("_", "-")
        os.environ["KERF_INSTANCE"] = instance
        os.environ.pop("KERF_RUN_ID", None)
        self.host = subprocess.Popen([str(BIN / "rtapi_app"), *(["--virtual"] if virtual else [])], stdin=subprocess.DEVNULL,
                                     stdout=subprocess.DEVNULL)

    def __enter__(self):
        for _ in range(500):
            # What only the host can answer: the memory is there before it listens.
            done = subprocess.run([str(BIN / "halcmd"), "-Q", "unlock", "all"], capture_output=True, check=False)
            if done.returncode == 0:
                return self
            if self.host.poll() is not None:
                raise HalError("rtapi_app did not start")
            # No sleep of ours: the host is asked again.
            try:
                self.host.wait(0.02)
            except subprocess.TimeoutExpired:
                pass
        raise HalError("rtapi_app does not answer")

    def __exit__(self, *_):
        self.host.terminate()
        self.host.wait()
