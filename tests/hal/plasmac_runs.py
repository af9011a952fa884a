"""Random runs of plasmac that make sense: a table that follows its offsets, a program that can be paused, and what an operator and a torch do to
it. Inputs drawn freely never get as far as an arc. compare_with_peer --random uses it; a run that showed something is kept as a .case."""
import random

UNIT = 10  # cycles; events happen at multiples of it
LENGTH = 140  # units

FIXED = """\
loadrt plasmac
loadrt conv_s32_float count=3
loadrt mult2 count=3
loadrt limit2 count=3
loadrt sum2
loadrt comp count=2
loadrt mux2 count=3
loadrt wcomp
loadrt not count=3
loadrt or2 count=5
loadrt and2 count=4
loadrt flipflop
setp wcomp.0.min -0.00001
setp wcomp.0.max 0.00001
setp comp.0.in1 20
setp comp.0.hyst 0.00001
setp comp.1.in1 20.2
setp comp.1.hyst 0.00001
setp sum2.0.in1 25
setp plasmac.axis-z-min-limit 0
setp plasmac.axis-z-max-limit 95
setp plasmac.axis-x-min-limit 0
setp plasmac.axis-x-max-limit 1000
setp plasmac.axis-y-min-limit 0
setp plasmac.axis-y-max-limit 1000
net plasmac.z-offset-counts conv-s32-float.0.in
net conv-s32-float.0.out mult2.0.in0
net plasmac.offset-scale mult2.0.in1 mult2.1.in1 mult2.2.in1
net mult2.0.out limit2.0.in
net limit2.0.out plasmac.z-offset-current sum2.0.in0 wcomp.0.in
net sum2.0.out plasmac.axis-z-position comp.0.in0 comp.1.in0
net plasmac.x-offset-counts conv-s32-float.1.in
net conv-s32-float.1.out mult2.1.in0
net mult2.1.out limit2.1.in
net limit2.1.out plasmac.x-offset-current
net plasmac.y-offset-counts conv-s32-float.2.in
net conv-s32-float.2.out mult2.2.in0
net mult2.2.out limit2.2.in
net limit2.2.out plasmac.y-offset-current
net comp.0.out or2.2.in0
net or2.2.out plasmac.float-switch
net comp.1.out and2.2.in0
net plasmac.ohmic-enable and2.2.in1
net and2.2.out or2.3.in0
net or2.3.out plasmac.ohmic-probe
net plasmac.torch-on mux2.0.sel
net mux2.0.out plasmac.arc-voltage-in
net plasmac.feed-hold mux2.1.sel
net mux2.1.out plasmac.current-velocity
net wcomp.0.out not.0.in
net not.0.out plasmac.offsets-active
net plasmac.program-pause or2.0.in0
net or2.0.out flipflop.0.set
net plasmac.program-resume or2.1.in0
net or2.1.out flipflop.0.reset
net or2.4.out plasmac.program-is-idle not.1.in
net flipflop.0.out and2.0.in0 not.2.in
net not.1.out and2.0.in1 and2.1.in0
net not.2.out and2.1.in1
net and2.0.out plasmac.program-is-paused
net and2.1.out plasmac.program-is-running
addf or2.4
addf plasmac
addf conv-s32-float.0
addf conv-s32-float.1
addf conv-s32-float.2
addf mult2.0
addf mult2.1
addf mult2.2
addf limit2.0
addf limit2.1
addf limit2.2
addf sum2.0
addf comp.0
addf comp.1
addf mux2.0
addf mux2.1
addf wcomp.0
addf or2.0
addf or2.1
addf or2.2
addf and2.2
addf or2.3
addf flipflop.0
addf not.0
addf not.1
addf not.2
addf and2.0
addf and2.1
"""
# What the pins of events stand for.
VOLTS, SPEED, PAUSE, RESUME, FLOAT = "mux2.0.in1", "mux2.1.in0", "or2.0.in1", "or2.1.in1", "or2.2.in1"
IDLE, START = "or2.4.in0", "plasmac.cutting-start"

NORMAL = {
    "mode": 0, "units-per-mm": 1, "arc-voltage-scale": 1, "arc-ok-high": 250, "arc-ok-low": 60, "arc-max-starts": 3,
    "arc-fail-delay": 0.1, "restart-delay": 0.1, "cut-height": 1.5, "pierce-height": 4, "pierce-delay": 0.05, "cut-volts": 99,
    "cut-feed-rate": 3000, "float-switch-travel": 0.5, "thc-feed-rate": 6000, "thc-threshold": 0.5, "thc-delay": 0.05,
    "pid-p-gain": 10, "height-per-volt": 0.1, "feed-override": 1, "setup-feed-rate": 30000, "probe-feed-rate": 12000,
    "probe-start-height": 22, "safe-height": 3, "probe-final-speed": 10, "ohmic-max-attempts": 2, "ohmic-probe-offset": 0.3,
    "xy-feed-rate": 6000, "axis-x-position": 5, "axis-y-position": 50, "torch-pulse-time": 0.05, "scribe-arm-delay": 0.05, "scribe-on-delay": 0.03, "spotting-time": 50,
}
# What a machine may have instead, one at a time or some together.
OTHER = {
    "mode": [1, 2], "arc-lost-delay": [0.03, 0.1], "arc-max-starts": [1, 0], "pause-at-end": [0.05], "pierce-delay": [0, 0.1],
    "safe-height": [0, 20, 200], "skip-ihs-distance": [50, 4], "ohmic-probe-enable": [1], "offset-probe-x": [2], "offset-probe-y": [-1],
    "offset-probe-delay": [0.04], "thc-auto": [1], "use-auto-volts": [1], "cornerlock-enable": [1], "cornerlock-threshold": [90],
    "voidlock-enable": [1], "mesh-enable": [1], "ignore-arc-ok-0": [1], "low-cut-volts": [70], "lowpass-frequency": [20],
    "puddle-jump-delay": [0.1], "puddle-jump-height": [80], "pid-i-gain": [2], "pid-d-gain": [1], "feed-reduction": [60],
    "cut-feed-rate": [0], "feed-upm": [3000], "cut-volts": [0], "cut-height": [0], "float-switch-travel": [0], "spotting-threshold": [50],
    "thc-sample-counts": [10], "target-samples": [1], "thc-delay": [0, 0.2], "setup-feed-rate": [6000], "probe-final-speed": [1],
}


class Run:
    def __init__(self, seed):
        rng = random.Random(f"plasmac {seed}")
        self.sets = dict(NORMAL)
        for key in rng.sample(sorted(OTHER), rng.choice([0, 1, 2, 4])):
            self.sets[key] = rng.choice(OTHER[key])
        if not {"offset-probe-x", "offset-probe-y"} & set(self.sets):
            self.sets.pop("offset-probe-delay", None)  # LinuxCNC waits for ever
        # To a cut by hand LinuxCNC answers with a pause of the program, for ever.
        # With no start allowed it begins the cut again and again.
        self.heights = self.sets["cut-height"] > 0 and self.sets["cut-volts"] > 0 and self.sets["arc-max-starts"] > 0
        # LinuxCNC begins such a cut at a height of a cut that there was not.
        self.spots = self.sets.get("skip-ihs-distance") is None
        self.lag = rng.choice([1000, 1000, 300])
        self.events = []  # (unit, pin, value)
        self.do(1, "plasmac.machine-is-on", 1)
        self.do(1, "plasmac.homed", 1)
        self.do(1, "plasmac.torch-enable", 1)
        self.do(1, "plasmac.thc-enable", 1)
        self.do(0, IDLE, 1)
        self.do(0, VOLTS, 100)
        if self.sets["mode"]:
            self.do(0, "plasmac.arc-ok-in", 1)
        self.rng = rng
        self.runs = rng.random() >= 0.15
        if self.runs:
            self.with_program()
        else:
            self.without_program()

    def do(self, at, pin, value):
        if at < LENGTH:
            self.events.append((at, pin, value))

    def for_a_while(self, at, pin, value, after, longest=8):
        self.do(at, pin, value)
        end = at + self.rng.randint(1, longest)
        self.do(end, pin, after)
        return end

    def without_program(self):
        rng, at = self.rng, 5
        while at < 110:
            what = rng.choice(["pulse", "ohmic", "probe", "scribe", "out"] + ["hand"] * self.heights)
            pin = {"pulse": "plasmac.torch-pulse-start", "ohmic": "plasmac.ohmic-test", "probe": "plasmac.probe-test",
                   "scribe": "plasmac.scribe-start", "hand": START, 
                   "out": rng.choice(["plasmac.offset-set-probe", "plasmac.offset-set-scribe"])}[what]
            end = self.for_a_while(at, pin, 1, 0, 4 if what == "pulse" else 35)
            self.disturb(rng.randint(at, end + 3))
            at = end + rng.randint(1, 25)

    def with_program(self):
        rng = self.rng
        self.do(3, IDLE, 0)
        at = 5
        start = rng.choice([START] * 8 + ["plasmac.spotting-start"] * self.spots + ["plasmac.scribe-start"])
        self.do(at, start, 1)
        self.do(21, SPEED, 50)
        begins_anew = False
        for _ in range(rng.choice([1, 1, 2, 3])):
            what = rng.choice(["pause", "pause", "disturb", "disturb", "end", "end", "abort", "off"])
            if what == "off" and start == "plasmac.scribe-start":  # LinuxCNC leaves it on
                what = "end"
            if what == "end" and begins_anew:  # LinuxCNC goes to a height above the material of the job before
                what = "disturb"
            begins_anew = begins_anew or what in ("abort", "off")
            when = at + rng.randint(1, 60)
            if what == "pause":
                at = self.pause(when)
            elif what == "disturb":
                at = self.disturb(when)
                self.do(at + rng.randint(5, 30), RESUME, 1)
                self.do(at + 31, RESUME, 0)
            elif what == "end":
                self.do(when, start, 0)
                at = when + rng.randint(1, 20)
                self.do(at - 1, "plasmac.axis-x-position", rng.choice([3, 30]))
                self.do(at, start, 1)
            elif what == "abort":
                self.do(when, IDLE, 1)
                self.do(when + rng.choice([0, 0, 1]), start, 0)
                at = when + rng.randint(3, 30)
                self.do(at, IDLE, 0)
                self.do(at + rng.randint(0, 3), start, 1)
            else:
                at = self.for_a_while(when, "plasmac.machine-is-on", 0, 1)
                self.do(when + 1, IDLE, 1)
                self.do(when + 1, start, 0)
            at += 1

    def pause(self, when):
        rng = self.rng
        self.for_a_while(when, PAUSE, 1, 0, 1)
        at = when + rng.randint(1, 20)
        for _ in range(rng.choice([1, 1, 2])):
            what = rng.choice(["nothing", "recover", "recover", "change", "move", "laser", "disturb"])
            if what == "recover" or what == "laser":
                self.do(at, "plasmac.laser-x-offset", 1000)
                if what == "laser":
                    self.for_a_while(at, "plasmac.laser-recovery-start", 1, 0, 20)
                self.do(at, "plasmac.cut-recovery", 1)
                self.do(at + rng.randint(0, 4), "plasmac.x-offset", rng.choice([2000, -500, 20000]))
                self.do(at + rng.randint(0, 4), "plasmac.y-offset", rng.choice([0, 700]))
                end = at + rng.randint(1, 60)
                self.do(end, "plasmac.cut-recovery", 0)
            elif what == "change":
                self.do(at, "plasmac.x-offset", 1000)
                self.do(at, "plasmac.y-offset", -2000)
                end = self.for_a_while(at, "plasmac.consumable-change", 1, 0, 30)
            elif what == "move":
                end = self.for_a_while(at, "plasmac.paused-motion-speed", rng.choice([0.5, -1, 2]), 0, 15)
            elif what == "disturb":
                end = self.disturb(at)
            else:
                end = at
            at = end + rng.randint(1, 20)
        if rng.random() < 0.25:
            self.do(at - 1, IDLE, 1)
            self.do(at - 1, START, 0)
        at -= rng.choice([0, 0, 0, 5])
        self.for_a_while(at, RESUME, 1, 0, 1)
        return at

    def disturb(self, when):
        rng = self.rng
        pin, value, after = rng.choice([
            (VOLTS, 2, 100), (VOLTS, 2, 100), (VOLTS, 62, 100), (VOLTS, 105, 98), (VOLTS, 97, 101), (VOLTS, 300, 100), (VOLTS, 130, 100),
            ("plasmac.breakaway", 1, 0), (FLOAT, 1, 0), ("or2.3.in1", 1, 0), ("plasmac.torch-off", 1, 0), ("plasmac.torch-enable", 0, 1),
            ("plasmac.thc-disable", 1, 0), ("plasmac.thc-enable", 0, 1), ("plasmac.mesh-enable", 1, 0), ("plasmac.ignore-arc-ok-1", 1, 0),
            ("plasmac.height-override", 5, -3), (SPEED, 20, 50), ("plasmac.feed-reduction", 50, 0), ("plasmac.move-up", 1, 0),
            ("plasmac.move-down", 1, 0), ("plasmac.ohmic-sense-in", 1, 0), ("plasmac.homed", 0, 1), ("plasmac.arc-ok-in", 0, 1),
            ("plasmac.override-jog", 1, 0), ("plasmac.motion-type", 1, 2), ("plasmac.cut-recovery", 1, 0),
            ("plasmac.consumable-change", 1, 0), ("plasmac.voidlock-enable", 1, 0), ("comp.0.in1", -100, 20)])
        if pin == VOLTS and value == 2 and not self.runs:  # LinuxCNC keeps such an arc without height control
            return when
        return self.for_a_while(when, pin, value, after, 12)

    def case(self):
        """The text of a .case. Each driven pin begins at 0 or what stands for unit 0."""
        lines = [FIXED.rstrip(), f"cycles {LENGTH * UNIT}"]
        lines += [f"setp limit2.{i}.maxv {self.lag}" for i in range(3)]
        lines += [f"setp plasmac.{key} {value}" for key, value in sorted(self.sets.items())]
        columns = {}
        for at, pin, value in sorted(self.events, key=lambda e: e[0]):
            column = columns.setdefault(pin, [0 if pin not in ("comp.0.in1",) else 20])
            column += [column[-1]] * (at + 1 - len(column))
            column[at] = value
        for pin, column in columns.items():
            # Driven and set at once is an error.
            lines = [line for line in lines if line.split()[:2] != ["setp", pin]]
            if column[0] == 0 and f"plasmac.{pin[8:]}" == pin and pin[8:] in self.sets and len(column) > 1:
                column[:] = [self.sets[pin[8:]] if value == 0 else value for value in column]
            lines.append(f"seq {pin} hold={UNIT} " + " ".join(map(str, column)))
        return "\n".join(lines) + "\n"

    def told(self):
        odd = {k: v for k, v in self.sets.items() if NORMAL.get(k) != v}
        return f"{odd} lag {self.lag} " + " ".join(f"{at}:{pin.removeprefix('plasmac.')}={value}" for at, pin, value in sorted(self.events)
                                                   if at > 1)
