"""Random programs for compare_with_peer --random: short, mostly right, the same for the same seed.

Each program is one theme of the manual (moves, arcs, offsets, cycles, O-words, expressions, spindle and I/O, everything
mixed) so that a difference is easy to read; about one line in fifty is wrong on purpose. What 2.9 does wrong by a row of docs/differences.md is left out: units
and G28 with a tool offset (G49 before), a rotation under G92 (G92.2 before), a G38 that does not move or in G93 (G94 before,
G80 behind), M72 out of G93, a do behind a break.
"""
import random

import random_motion

AXES = "XYZABC"
TOOLS = "T1 P1 Z1.5 D0.25\nT2 P2 X0.5 Z-2 D0.5 I95 J155 Q2\nT7 P3 X1 Y2 Z3 A4 B5 C6 D1 ;a comment\n"


class Program:
    def __init__(self, seed):
        self.rng = random.Random(seed)
        self.lines = []
        self.label = 100
        self.feed_known = False
        self.inverse_time = seed % 3 == 0
        self.breaks = seed % 2 == 0  # else do

    def number(self, low=-20, high=20):
        r = self.rng
        kind = r.random()
        if kind < 0.4:
            return str(r.randint(low, high))
        if kind < 0.8:
            return f"{r.uniform(low, high):.{r.randint(1, 4)}f}"
        if kind < 0.9:
            return f"[{r.randint(low, high)}{r.choice(['+', '-', '*'])}{r.uniform(0.1, 3):.2f}]"
        return f"#{r.randint(1, 5)}"

    def axes(self, pool="XYZ", least=1):
        r = self.rng
        chosen = r.sample(pool, r.randint(least, len(pool)))
        return " ".join(f"{axis}{self.number()}" for axis in chosen)

    def add(self, text):
        r = self.rng
        if r.random() < 0.05:
            text = text.lower()
        if r.random() < 0.05:
            text = f"N{r.randint(1, 9999)} {text}"
        if r.random() < 0.04:
            text += r.choice([" (note)", " ; note", "(MSG, look)", " (debug, #1 is [#1])"])
        if r.random() < 0.1:
            text = text.replace(" ", "")
        self.lines.append(text)

    # --- lines by theme ---
    def moves(self):
        r = self.rng
        self.add(r.choice([
            lambda: f"G0 {self.axes('XYZABC')}",
            lambda: f"G1 {self.axes('XYZABC')} F{r.randint(1, 900)}",
            lambda: f"G1 {self.axes()}",
            lambda: self.axes(),
            lambda: r.choice(["G90", "G91", "G49\nG20", "G49\nG21", "G61", "G61.1", "G64", "G64 P0.1", "G64 P0.05 Q0.02"]),
            lambda: f"G53 G0 {self.axes()}",
            lambda: f"G4 P{r.uniform(0, 2):.2f}",
            lambda: r.choice(["G93", "G94", "G17", "G18", "G19", "G94 F100"]),
            lambda: f"G94 G38.3 X{r.uniform(21, 40):.3f} F50\nG80",
            lambda: f"G0 @{r.randint(1, 20)} ^{r.randint(-180, 180)}",
            lambda: "G80",
            lambda: "G49\n" + r.choice(["G28", f"G28 {self.axes()}", "G30", "G28.1", "G30.1"]),
        ])())

    def arcs(self):
        r = self.rng
        plane = r.choice([("G17", "XY", "IJ", "Z"), ("G18", "XZ", "IK", "Y"), ("G19", "YZ", "JK", "X")])
        if r.random() < 0.3:
            self.add(plane[0])
            self.plane = plane
        plane = getattr(self, "plane", ("G17", "XY", "IJ", "Z"))
        a, b = plane[1]
        i, j = plane[2]
        kind = r.random()
        if kind < 0.35:  # a centre and an end on the same circle: from the present point back to it
            turns = f" P{r.randint(1, 3)}" if r.random() < 0.3 else ""
            helix = f" {plane[3]}{self.number()}" if r.random() < 0.3 else ""
            self.add(f"G{r.choice('23')} {i}{r.uniform(0.5, 9):.3f} {j}{r.uniform(-9, 9):.3f}{helix}{turns}")
        elif kind < 0.6:
            self.add(f"G91 G{r.choice('23')} {a}{r.uniform(1, 4):.3f} {b}{r.uniform(-3, 3):.3f} "
                     f"R{r.choice(['', '-'])}{r.uniform(3, 20):.3f}")
        elif kind < 0.75:  # quarter of a circle, incremental
            radius = r.randint(1, 9)
            self.add(f"G91 G2 {a}{radius} {b}{radius} {i}{radius} {j}0")
        elif kind < 0.9:
            self.add(r.choice(["G90", "G91", "G91.1", "G49\nG20", "G49\nG21", "G94", f"F{r.randint(10, 500)}"]))
        else:
            self.add(f"G{r.choice('01')} {self.axes()}")

    def offsets(self):
        r = self.rng
        self.add(r.choice([
            lambda: "G92.2\n" + f"G10 L2 P{r.randint(0, 9)} {self.axes('XYZABC')}" + (f" R{r.randint(-90, 90)}" if r.random() < .3 else ""),
            lambda: f"G10 L20 P{r.randint(0, 9)} {self.axes('XYZABC')}",
            lambda: r.choice(["G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"]),
            lambda: f"G92 {self.axes('XYZA')}",
            lambda: f"G52 {self.axes()}",
            lambda: r.choice(["G92.1", "G92.2", "G92.3"]),
            lambda: f"G0 {self.axes('XYZABC')}",
            lambda: f"G43 H{r.choice([1, 2, 7])}",
            lambda: f"G43.1 {self.axes()}",
            lambda: "G49",
            lambda: f"T{r.choice([1, 2, 7])} M6",
            lambda: f"G10 L1 P{r.choice([1, 2, 7])} {self.axes()} R{r.uniform(0, 3):.2f}",
            lambda: f"G10 L{r.choice([10, 11])} P{r.choice([1, 2, 7])} {self.axes()}",
            lambda: r.choice(["G90", "G91", "G49\nG20", "G49\nG21"]),
            lambda: "G49\n" + r.choice(["G28.1", "G30.1", "G28", f"G30 {self.axes()}"]),
            lambda: f"(debug, #{r.choice([5220, 5221, 5222, 5223, 5230, 5211, 5210, 5161, 5420, 5421])} "
                    f"#{r.choice([5241, 5261, 5281, 5301, 5321, 5361, 5381, 5422])} #<_x> #<_abs_y>)".replace(" #<_abs_y>", ""),
        ])())

    def cycles(self):
        r = self.rng
        code = r.choice(["G81", "G82", "G85", "G86", "G89", "G81"])  # G73, G83: the newest backs off otherwise
        extra = {"G82": " P0.5", "G86": " P0.1", "G89": " P.2"}.get(code, "")
        self.add(r.choice([
            lambda: f"{code} X{self.number()} Y{self.number()} Z{-r.randint(1, 6)} R{r.randint(1, 4)}{extra}"
                    + (f" L{r.randint(1, 3)}" if r.random() < .3 else ""),
            lambda: f"{code} X{self.number()} Z{-r.randint(1, 6)} R{r.randint(1, 4)}{extra}",
            lambda: f"X{self.number()}",
            lambda: f"X{self.number()} Y{self.number()}",
            lambda: "G80",
            lambda: r.choice(["G98", "G99", "G90", "G91", "G17", "G18", "G19", "G61", "G64 P.1"]),
            lambda: f"G0 {self.axes()}",
            lambda: f"G0 Z{r.randint(2, 12)}",
        ])())

    def words(self):
        r = self.rng
        self.add(r.choice([
            lambda: f"M{r.choice([3, 4])} S{r.randint(0, 4000)}",
            lambda: r.choice(["M5", "M7", "M8", "M9", "M7 M8", "M48", "M50", "M50 P0", "M52 P1", "M53 P1"]),
            lambda: r.choice(["G96 S100 D2000", "G96 S50", "G97 S300", "G97", "S600"]),
            lambda: r.choice(["M62 P0", "M63 P1", "M64 P2", "M65 P3", "M67 E0 Q1.5", "M68 E1 Q-2", "M66 P0 L0", "M66 E0 L0",
                              "M66 P1 L3 Q1"]),
            lambda: r.choice(["M0", "M1", "M60", "M70", "M71", "M71" if self.inverse_time else "M72"]),
            lambda: r.choice(["M19 R90", "M19 R10 Q2", "M19 R0 P1", "G95", "G94", "G93" if self.inverse_time else "G94", "G7", "G8"]),
            lambda: f"F{r.randint(0, 300)}",
            lambda: f"G1 X{self.number()} F{r.randint(1, 99)} S{r.randint(1, 99)} M3",
            lambda: f"G0 {self.axes()}",
        ])())

    def expression(self, depth=0):
        r = self.rng
        if depth > 2 or r.random() < 0.3:
            return r.choice([str(r.randint(-9, 9)), f"{r.uniform(-5, 5):.3f}", f"#{r.randint(1, 5)}", "#<v>", "#<_g>"])
        kind = r.random()
        if kind < 0.6:
            op = r.choice(["+", "-", "*", "/", "**", "MOD", "AND", "OR", "XOR", "EQ", "NE", "GT", "GE", "LT", "LE"])
            return f"[{self.expression(depth + 1)} {op} {self.expression(depth + 1)}]"
        if kind < 0.9:
            return f"{r.choice(['ABS', 'ACOS', 'ASIN', 'COS', 'EXP', 'FIX', 'FUP', 'LN', 'ROUND', 'SIN', 'SQRT', 'TAN'])}" \
                   f"[{self.expression(depth + 1)}]"
        if kind < 0.95:
            return f"ATAN[{self.expression(depth + 1)}]/[{self.expression(depth + 1)}]"
        return f"[0 - {self.expression(depth + 1)}]"

    def expressions(self):
        r = self.rng
        target = r.choice([f"#{r.randint(1, 5)}", "#<v>", "#<_g>"])
        self.add(f"{target} = [{self.expression()}]")
        if r.random() < 0.4:
            self.lines.append(f"(debug, {target} #1 #<v> #<_g>)")

    def body(self, depth, quantity):
        for _ in range(quantity):
            if depth < 2 and self.rng.random() < 0.35:
                self.flow(depth + 1)
            else:
                self.lines.append(self.rng.choice([f"G0 X#{self.rng.randint(1, 5)}", "#2 = [#2 + 1]", "(debug, #1 #2 #3)",
                                                   f"G0 Y{self.number()}", "#3 = [#1 * #2]"]))

    def branch(self, depth, *lines):
        self.lines += lines
        self.body(depth, 1)

    def flow(self, depth=0):
        r = self.rng
        self.label += 1
        label = r.choice([str(self.label), f"<name{self.label}>", f"<Name {self.label}>"])
        kind = r.randint(0, 5)
        lines = self.lines
        counter = f"#{10 + depth}"
        start, step = f"{counter} = 0", f"{counter} = [{counter} + 1]"
        if kind == 0:
            self.branch(depth, f"o{label} if [#{r.randint(1, 3)} {r.choice(['LT', 'GT', 'EQ'])} {r.randint(0, 4)}]")
            if r.random() < 0.5:
                self.branch(depth, f"o{label} elseif [#2 GT {r.randint(0, 6)}]")
            if r.random() < 0.5:
                self.branch(depth, f"o{label} else")
            lines.append(f"O{label} endif")
        elif kind == 1:
            lines.append(f"o{label} repeat [{r.randint(0, 3)}]")
            self.body(depth, 2)
            lines.append(f"o{label} endrepeat")
        elif kind == 2:
            self.branch(depth, start, f"o{label} while [{counter} LT {r.randint(1, 3)}]", step)
            if r.random() < 0.3:
                lines.append(f"o{label} {r.choice(['break', 'continue'] if self.breaks else ['continue'])}")
            lines.append(f"o{label} endwhile")
        elif kind == 3 and not self.breaks:
            self.branch(depth, start, f"o{label} do", step)
            lines.append(f"o{label} while [{counter} LT {r.randint(1, 3)}]")
        elif depth == 0:
            lines.append(f"o{label} sub")
            self.body(1, 2)
            if r.random() < 0.4:
                lines.append(f"o{label} return [#1 + {r.randint(1, 5)}]")
            lines.append(f"o{label} endsub" + (f" [#2 * 2]" if r.random() < 0.5 else ""))
            for _ in range(r.randint(1, 2)):
                lines.append(f"o{label} call " + " ".join(f"[{self.number()}]" for _ in range(r.randint(0, 4))))
                lines.append("(debug, #<_value> #<_value_returned> #1 #2)")
        else:
            self.body(depth, 1)

    def wrong(self):
        self.lines.append(self.rng.choice([
            "G1 X1 X2", "G0 G1 X3", "M3 M4", "G2 X5", "X5 G999", "G0 X[1/0]", "#1 = #<none>", "G10 L5 P1", "T55", "G43 H55",
            "G0 Y-", "(unclosed", "G91 G53 G0 X1", "G81 X1", "M66", "M62", "G92", "o9 endif", "M199", "G4", "G41.1 X1", "R5", "P2"]))

    def text(self, theme, length):
        r = self.rng
        self.lines = [f"F{r.randint(50, 500)}"] if theme in ("arcs", "cycles") or r.random() < 0.7 else []
        if theme in ("flow", "expressions", "mixed"):
            self.lines += ["#<v> = 2", "#<_g> = 3"]
        themes = ["moves", "arcs", "offsets", "cycles", "words", "expressions", "flow"]
        for _ in range(length):
            if r.random() < 0.02:
                self.wrong()
            getattr(self, theme if theme != "mixed" else r.choice(themes))()
        self.lines.append(r.choice(["M2", "M2", "M30"]))
        return "\n".join(self.lines) + "\n"


THEMES = ["moves", "arcs", "offsets", "cycles", "words", "expressions", "flow", "mixed", "motion"]


def program(seed, theme=None):
    """(theme, text) of one seed."""
    chosen = theme or THEMES[seed % len(THEMES)]
    if chosen == "motion":
        return chosen, random_motion.program(seed)
    return chosen, Program(seed).text(chosen, 4 + seed % 17)
