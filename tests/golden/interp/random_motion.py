"""Random programs of the theme "motion" for compare_with_peer --random: moves, arcs, canned cycles, splines, probes and modes
in mixed order. They keep track of plane, spindle and cycle, so that most blocks run, and keep clear of docs/differences.md.
"""
import random

# The built-in clearance of 2.9.
CONFIG = "[RS274NGC]\nG73_PECK_CLEARANCE = 0.010\nG83_PECK_CLEARANCE = 0.010\n"


class Programs:
    def __init__(self, seed):
        self.r = random.Random(seed)

    def number(self, low=-9.0, high=9.0):
        r = self.r
        value = r.choice([r.uniform(low, high), float(r.randint(int(low), int(high)))])
        digits = r.choice([0, 1, 2, 3, 4])
        text = f"{value:.{digits}f}"
        return text

    def maybe(self, chance, text):
        return text if self.r.random() < chance else ""

    def words(self, letters, chance, low=-9.0, high=9.0):
        return " ".join(f"{c}{self.number(low, high)}" for c in letters if self.r.random() < chance)

    def straight(self):
        r = self.r
        code = r.choice(["G0", "G1", "G1", "G0", self.maybe(0.05, "G53 ") + "G1"])
        self.cycle_code = ""
        axes = self.words("XYZ", 0.6) + " " + self.words("ABC", 0.1)
        if r.random() < 0.12 and self.plane == "G17":
            axes = f"@{self.number(0, 9)} ^{self.number(-200, 200)}" + self.maybe(0.3, " Z1")
            axes = r.choice([axes, axes.split()[0], axes.split()[1]])
        return f"{code} {axes}" + self.maybe(0.1, f" F{self.number(1, 200)}")

    def in_plane(self):
        return {"G17": "XYIJZ", "G18": "XZIKY", "G19": "YZJKX"}.get(self.plane, "XYIJZ")

    def arc(self):
        r = self.r
        code = r.choice(["G2", "G3"])
        self.cycle_code = ""
        turns = self.maybe(0.15, f" P{r.choice(['1', '2', '3', '4', '7'])}")
        a, b, i, j, normal = self.in_plane()
        helix = self.maybe(0.3, " " + self.words(normal + "A", 0.5))
        kind = r.random()
        if kind < 0.3 and not self.absolute_centre:  # full circle
            offsets = r.choice([f"{i}{self.number(1)}", f"{j}{self.number(-9, -1)}", f"{i}{self.number(1)} {j}{self.number()}"])
            return f"{code} {offsets}{helix}{turns}"
        if kind < 0.55 and not self.absolute_centre:  # a quarter or three, about a corner
            size = r.randint(1, 5)
            s, t = r.choice([1, -1]), r.choice([1, -1])
            self.incremental = True
            centre = r.choice([f"{i}{s * size}", f"{j}{t * size}"])
            return f"G91 {code} {a}{s * size} {b}{t * size} {centre}{helix}{turns}"
        if kind < 0.92:
            return f"{code} {a}{self.number()} {self.words(b, 0.8)} R{self.number(20, 60)}{helix}{turns}"
        turns = r.choice([turns, " P0", " P1.5", " P-1"])
        return f"{code} {self.words('XYZ', 0.6)} {self.words('IJKR', 0.4)}{turns}"

    def cycle(self):
        r = self.r
        if self.plane.endswith(".1") and r.random() < 0.9:
            self.plane = r.choice(["G17", "G18", "G19"])
            return self.plane
        fresh = not self.cycle_code or r.random() < 0.5
        code = self.cycle_code
        if fresh:
            code = r.choice(["G81", "G82 P1", "G83 Q0.7", "G73 Q1.3", "G85", "G89 P.5", "G82 P2"] +
                            {"M3": ["G84 P1", "G86 P1", "G87 I1 J2 K-1", "G84 P.3"], "M4": ["G74 P2", "G86 P.2", "G87 I1 J2 K-1"],
                             "M5": []}[self.spindle])
        a, b, _, _, normal = self.in_plane()
        if self.plane != "G17" and code[:3] in ("G84", "G74"):  # there 2.9 mixes up the axes
            code = "G82 P1"
        repeat = not code.startswith(("G74", "G84"))  # 2.9 refuses L there
        self.cycle_code = code.split()[0]
        block = (code if fresh else r.choice([code, ""])) + f" {a}{self.number()} {self.words(b, 0.5)}"
        if fresh or r.random() < 0.3:
            block += f" {normal}{self.number(-9, -2)}"
        if fresh or r.random() < 0.3:
            block += f" R{self.number(0, 9)}"
        block += self.maybe(0.15 * repeat, f" L{r.choice(['2', '3', '1', '4'])}")
        block += self.maybe(0.1, f" F{self.number(1, 200)}")
        if r.random() < 0.04:
            block += " " + r.choice(["A1", "B2", "L-1", "L0", "L1.5", "I1", "K2", "E1", "H2", "U1"])
        return block

    def spline(self):
        r = self.r
        kind = r.random()
        self.cycle_code = ""
        if self.plane != "G17" and r.random() < 0.9:
            self.plane = "G17"
            return "G17"
        if kind < 0.4:
            return (f"G5 X{self.number()} {self.words('Y', 0.9)} I{self.number()} J{self.number()} "
                    f"P{self.number()} Q{self.number()}" + self.maybe(0.05, " Z1"))
        if kind < 0.7:
            return f"G5.1 {self.words('X', 0.9)} Y3 I{self.number(1)} J{self.number(1)}" + self.maybe(0.05, " A1")
        order = r.choice([3, 4, 2])
        lines = [f"G5.2 P{r.choice(['1', '2', '.5'])} L{order}"]
        for _ in range(r.randint(order - self.r.randint(0, 1), 6)):
            lines.append(f"X{self.number()} Y{self.number()} P{r.choice(['1', '2', '.7'])}")
        lines.append("G5.3")
        self.cycle_code = ""
        return "\n".join(lines)

    def mode(self):
        r = self.r
        choice = r.choice([
            "G17", "G17", "G17", "G18", "G19", "G17.1", "G18.1", "G19.1", "G90", "G90", "G90", "G91", "G90.1", "G91.1",
            "G91.1", "G98", "G99", "G61", "G61.1", "G64", f"G64 P{self.number(0, 1)}", "G64 P.1 Q.05", "G64 Q.2", "G80",
            "G94 F50", "M3 S100", "M4 S50", "M5", "M49", "M48", "M50 P0", "M51 P0", f"F{self.number(1, 300)}",
            f"S{self.number(1, 99)}", "G4 P1", "G94 F90", "G52 X1 Y2", "G55", "G54", "G92 X3 Z2",
            "G92.1", "(text)", "G10 L2 P1 R30", "G10 L2 P1 R0"] + (["G20", "G21"] if not self.cycle_code else []) +
            (["G4 P-1", "G4", "G17 G18", "G90 G91", "G999", "G12"] if r.random() < 0.05 else []))
        code = choice.split()[0]
        if code.startswith(("G17", "G18", "G19")) and len(choice.split()) == 1:
            self.plane = code
        if code in ("M3", "M4", "M5"):
            self.spindle = code
        if code in ("G90.1", "G91.1"):
            self.absolute_centre = code == "G90.1"
        if code == "G80":
            self.cycle_code = ""
        return choice

    def feed_mode(self):
        r = self.r
        self.cycle_code = ""
        return r.choice(["G93\nG1 X1 F2\nG94 F70", f"G93\nG1 X{self.number()} A9 Y2 F3\nG94 F50", "G95 F.2 S100", "G95 F1 S9",
                         "G94 F100", "G93\nG1 A9 F2\nG94 F9", self.maybe(0.1, "G93 G1 X3")])

    def probe(self):
        self.cycle_code = ""
        # 2.9's listing does not know where a spline ends
        return f"G0 X1 Y2 Z3\n{self.r.choice(['G38.2', 'G38.3', 'G38.4', 'G38.5'])} X{self.number(20, 40)} {self.words('YZ', 0.5)}" + self.maybe(0.05, " A1")

    def program(self):
        r = self.r
        families = {"straight": self.straight, "arc": self.arc, "cycle": self.cycle, "spline": self.spline,
                    "mode": self.mode, "feed": self.feed_mode, "probe": self.probe}
        names = ["straight"] * 3 + ["arc"] * 3 + ["cycle"] * 4 + ["spline", "mode", "mode", "mode", "feed", "probe"]
        self.plane, self.spindle, self.cycle_code = "G17", r.choice(["M3", "M4"]), ""
        self.absolute_centre = False
        lines = [self.maybe(0.97, "F100") + f" {self.spindle} S200", f"G0 Z{self.number()} {self.words('XY', 0.7)}"]
        for _ in range(r.randint(2, 12)):
            block = families[r.choice(names)]()
            if r.random() < 0.15 and not set("\n@^") & set(block):
                block = f"{self.mode()} {block}"
                if "G10" in block and "G92" in block:  # 2.9 takes two codes of group 0
                    continue
            lines.append(block)
        return "\n".join(lines + ["M48", "M2", ""])


def program(seed):
    return Programs(seed).program()
