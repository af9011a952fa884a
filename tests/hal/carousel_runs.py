"""Random runs of carousel that make sense: sensors that show pocket after pocket with gaps between them, and a tool changer that asks for pockets,
stops, jogs and looks for the index. Sensors that change freely show no pocket. compare_with_peer --random uses it."""
import random

LENGTH = 400  # cycles
CODES = {
    "gray": lambda p: p ^ p >> 1, "binary": lambda p: p, "bcd": lambda p: p // 10 << 4 | p % 10, "single": lambda p: 1 << (p - 1),
}


class Run:
    def __init__(self, load, seed):
        self.load, self.rng = load, random.Random(f"{load} {seed}")
        self.encoding = dict(word.split("=") for word in load.split()[1:])["encoding"]
        self.pockets = int(dict(word.split("=") for word in load.split()[1:])["pockets"])

    def turning(self):
        """The pocket and the place within its mark (0 is its middle, 1 the one between two) of each cycle."""
        rng, pocket, way, column = self.rng, self.rng.randrange(self.pockets), 1, []
        while len(column) < LENGTH:
            if rng.random() < 0.15:
                way = -way
            rest, gap = rng.choice([3, 8, 20]), rng.choice([0, 1, 4]) if self.encoding in CODES else rng.choice([2, 4])
            column += [(pocket, way, i / rest / 2) for i in range(rest)]
            column += [(pocket, way, 0.5 + 0.001 * i) for i in range(1, gap + 1)]
            pocket += way
        return column[:LENGTH]

    def some(self, values, holds):
        """One of values for one of holds cycles, again and again."""
        column = []
        while len(column) < LENGTH:
            column += [self.rng.choice(values)] * self.rng.choice(holds)
        return column[:LENGTH]

    def jogs(self):
        """Short ones, of one pin or of both. Held until the pocket has gone again, a jog is LinuxCNC's last one."""
        rng, columns, at = self.rng, ([0] * LENGTH, [0] * LENGTH), self.rng.randrange(40)
        while at < LENGTH - 2:
            some = rng.choice([columns[:1], columns[:1], columns[1:], columns[1:], columns])
            # Both at once ask for the pocket that is there, which may be gone in the next cycle.
            length = 1 if self.encoding == "edge" or len(some) == 2 else rng.choice([1, 2])
            for column in some:
                column[at:at + length] = [1] * length
            at += length + rng.choice([3, 5, 12, 40])
        return columns

    def sensors(self):
        """Pin to its column."""
        turning, pockets = self.turning(), self.pockets
        if self.encoding == "counts":
            scale = self.rng.choice([100, 40])
            counts = [round((p + way * place) * scale) for p, way, place in turning]
            return scale, {"counts": counts, "sense-0": [int(p % pockets == 0 and place < 0.2) for p, _, place in turning]}
        if self.encoding in CODES:
            codes = [CODES[self.encoding](p % pockets + 1) if place <= 0.5 else 0 for p, _, place in turning]
            bits = max(codes).bit_length() if self.encoding == "single" else 4 if pockets < 10 else 5
            columns = {f"sense-{i}": [c >> i & 1 for c in codes] for i in range(bits)}
            columns["parity"] = [c.bit_count() & 1 for c in codes]
            return 0, columns
        return 0, {"sense-0": [int(p % pockets == 0 and place <= 0.5) for p, _, place in turning],
                   "sense-1": [int(place <= 0.5) for _, _, place in turning]}

    def case(self):
        rng = self.rng
        kind = rng.choice(["moves", "moves", "jogs", "lock"])
        scale, columns = self.sensors()
        lines = [f"loadrt {self.load}", f"cycles {LENGTH}", "addf carousel.0"]
        for pin in ("fwd-dc", "rev-dc", "hold-dc"):
            lines.append(f"setp carousel.0.{pin} {rng.choice([0.75, -0.5, 0.125, 1])}")
        if scale:
            for pin, value in (("scale", scale), ("home-offset", rng.choice([0, 0, 7, -20])), ("width", rng.choice([0, 5, scale // 2]))):
                lines.append(f"setp carousel.0.{pin} {value}")
        columns["pocket-number"] = self.some(list(range(1, self.pockets + 1)) + [0, self.pockets + 3, -2], [50, 120])
        columns["enable"] = self.some([0, 1, 1], [20, 60, 150])
        if kind == "jogs":
            columns["enable"] = self.some([0, 0, 1], [3, 20, 60])
            columns["jog-fwd"], columns["jog-rev"] = self.jogs()
        if kind == "lock":
            lines.append(f"setp carousel.0.rev-pulse {rng.choice([0.004, 0.02])}")
            # Without enable LinuxCNC goes on to push back.
            columns["enable"] = [int(i > 10) for i in range(LENGTH)]
        if rng.random() < 0.3:
            columns["strobe"] = self.some([1, 1, 0], [7, 30])
        if rng.random() < 0.3:
            columns["unhome"] = self.some([0, 0, 0, 0, 1], [3, 40])
        lines += [f"seq carousel.0.{pin} " + " ".join(map(str, column)) for pin, column in columns.items()]
        # What is asked for is not there while it turns to the index or is jogged; LinuxCNC leaves the pin as it was.
        if "unhome" in columns or kind == "jogs":
            lines.append("differs carousel.0.ready differences.md")
        if self.encoding == "counts":
            lines.append("differs carousel.0.index-enable differences.md")
        return "\n".join(lines) + "\n"
