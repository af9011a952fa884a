"""Programs as CAM posts and people write them, and the benchmark's families at other parameters, for compare_with_peer --posted: G-code text, and
each move as it is meant, so that distances from the path need no interpreter. Seeded; the same seed gives the same programs everywhere."""
import math
import random
from dataclasses import dataclass, field

PLANES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}
OFFSETS = {0: "I", 1: "J", 2: "K"}


@dataclass
class Move:
    start: list
    end: list
    centre: tuple = None  # in the plane
    left: bool = False
    plane: tuple = (0, 1, 2)
    turns: int = 1


def distance(move, place):
    """Of a place in XYZ from the move."""
    if move.centre is None:
        way = [b - a for a, b in zip(move.start[:3], move.end[:3])]
        square = sum(x * x for x in way)
        t = 0 if square == 0 else min(1.0, max(0.0, sum((q - a) * x for q, a, x in zip(place, move.start, way)) / square))
        return math.dist(place, [a + t * x for a, x in zip(move.start, way)])
    u, v, w = move.plane
    first = math.atan2(move.start[v] - move.centre[1], move.start[u] - move.centre[0])

    def turn(q):
        angle = math.atan2(q[v] - move.centre[1], q[u] - move.centre[0]) - first
        return (angle if move.left else -angle) % (2 * math.pi)

    def radius(q):
        return math.hypot(q[u] - move.centre[0], q[v] - move.centre[1])
    whole = turn(move.end)
    if whole < 1e-9:
        whole += 2 * math.pi
    whole += 2 * math.pi * (move.turns - 1)
    least, here = min(math.dist(place, move.start[:3]), math.dist(place, move.end[:3])), turn(place)
    while here <= whole + 1e-9:  # each turn of a helix
        share = here / whole
        level = move.start[w] + (move.end[w] - move.start[w]) * share
        there = radius(move.start) + (radius(move.end) - radius(move.start)) * share
        least = min(least, math.hypot(radius(place) - there, place[w] - level))
        here += 2 * math.pi
    return least


@dataclass
class Writer:
    """Writes blocks with as many digits as given and remembers the moves with these digits."""
    name: str
    mode: str  # G64 ..., G61
    p: float  # mm; 0: exact path
    feed: float = 3000  # mm/min
    digits: int = 4
    inch: bool = False
    at: list = field(default_factory=lambda: [0.0, 0.0, 0.0, 0.0])
    lines: list = field(default_factory=list)
    moves: list = field(default_factory=list)
    plane: int = 17
    floor: float = 0  # seconds at the programmed feeds
    inverse_time: bool = False  # G93

    def __post_init__(self):
        self.unit = 25.4 if self.inch else 1.0
        self.lines += [f"({self.name})", f"{'G20' if self.inch else 'G21'} G17 G40 G49 G80 G90 G94", self.mode, self.feed_word()]

    def feed_word(self):
        return f"F{self.feed / self.unit:.3f}"

    def set_feed(self, feed):
        self.feed = feed
        self.lines.append(self.feed_word())

    def rounded(self, x, axis=0):
        unit = 1.0 if axis == 3 else self.unit
        return round(x / unit, self.digits) * unit

    def words(self, to):
        out = ""
        for axis, letter in enumerate("XYZA"):
            if to[axis] != self.at[axis]:
                out += f" {letter}{to[axis] / (1.0 if axis == 3 else self.unit):.{self.digits}f}"
        return out

    def target(self, x, y, z, a):
        return [self.at[n] if v is None else self.rounded(v, n) for n, v in enumerate((x, y, z, a))]

    def go(self, x=None, y=None, z=None, a=None, rapid=False):
        to = self.target(x, y, z, a)
        words = self.words(to)
        if not words:
            return
        way = math.dist(self.at[:3], to[:3]) or abs(to[3] - self.at[3])
        per_minute = f" F{self.feed / way:.5f}" if self.inverse_time and not rapid else ""
        self.lines.append(("G0" if rapid else "G1") + words + per_minute)
        self.moves.append(Move(self.at, to))
        if not rapid:
            self.floor += math.dist(self.at[:3], to[:3]) / self.feed * 60
        self.at = to

    def rapid(self, x=None, y=None, z=None, a=None):
        self.go(x, y, z, a, True)

    def arc(self, centre, sweep, rise=0.0, a=None):
        """About `centre` in the plane, counterclockwise for sweep > 0 (seen as the manual has it), `rise` along its axis."""
        u, v, w = PLANES[self.plane]
        du, dv = self.at[u] - centre[0], self.at[v] - centre[1]
        end = list(self.at)
        end[u] = self.rounded(centre[0] + du * math.cos(sweep) - dv * math.sin(sweep))
        end[v] = self.rounded(centre[1] + du * math.sin(sweep) + dv * math.cos(sweep))
        end[w] = self.rounded(self.at[w] + rise)
        turns = 1
        if abs(sweep) >= 2 * math.pi - 1e-9:
            turns = round(abs(sweep) / (2 * math.pi))
            end[u], end[v] = self.at[u], self.at[v]
        if a is not None:
            end[3] = self.rounded(a, 3)
        offset = [self.rounded(-du), self.rounded(-dv)]
        if math.dist((self.at[u], self.at[v]), (end[u], end[v])) < 1e-9 and abs(sweep) < 6:
            return
        word = f"G{3 if sweep > 0 else 2}" + "".join(
            f" {'XYZ'[n]}{end[n] / self.unit:.{self.digits}f}" for n in (u, v, w) if n != w or end[w] != self.at[w])
        if end[3] != self.at[3]:
            word += f" A{end[3]:.{self.digits}f}"
        word += f" {OFFSETS[u]}{offset[0] / self.unit:.{self.digits}f} {OFFSETS[v]}{offset[1] / self.unit:.{self.digits}f}"
        if turns > 1:
            word += f" P{turns}"
        self.lines.append(word)
        self.moves.append(Move(self.at, end, (self.at[u] + offset[0], self.at[v] + offset[1]), sweep > 0, (u, v, w), turns))
        self.floor += math.hypot(sweep * math.hypot(du, dv), rise) / self.feed * 60
        self.at = end

    def turn_by(self, heading, radius, sweep, rise=0.0):
        """An arc that begins along `heading` in the plane; gives the heading at its end."""
        u, v, _ = PLANES[self.plane]
        side = heading + math.copysign(math.pi / 2, sweep)
        self.arc((self.at[u] + radius * math.cos(side), self.at[v] + radius * math.sin(side)), sweep, rise)
        return heading + sweep

    def along(self, heading, length, z=None):
        u, v, _ = PLANES[self.plane]
        to = [None, None, None]
        to[u] = self.at[u] + length * math.cos(heading)
        to[v] = self.at[v] + length * math.sin(heading)
        if z is not None:
            to[2] = z
        self.go(*to)

    def select(self, plane):
        self.plane = plane
        self.lines.append(f"G{plane}")

    def drill(self, places, depth, retract, code=81, peck=1.0):
        """The cycle at each of them, back to where Z was (G98)."""
        high = self.at[2]
        words = f"Z{depth / self.unit:.{self.digits}f} R{retract / self.unit:.{self.digits}f}"
        if code != 81:
            words += f" Q{peck / self.unit:.{self.digits}f}"
        for n, (x, y) in enumerate(places):
            to = self.target(x, y, None, None)
            head = f"G98 G{code} " if n == 0 else ""
            self.lines.append(f"{head}X{to[0] / self.unit:.{self.digits}f} Y{to[1] / self.unit:.{self.digits}f}" + (f" {words}" if n == 0 else ""))
            self.floor += abs(depth - retract) / self.feed * 60
            down, up = [to[0], to[1], depth, to[3]], [to[0], to[1], retract, to[3]]
            self.moves += [Move(self.at, to), Move(to, up), Move(up, down), Move(down, to)]
            self.at = [to[0], to[1], high, to[3]]
        self.lines.append("G80")

    def text(self):
        return "\n".join(self.lines + ["M2", ""])


# ---- what people mill; each takes the writer and the random numbers


def pocket(w, r):
    width, height, step, corner = r.uniform(15, 40), r.uniform(10, 30), r.uniform(0.8, 3), r.uniform(0.3, 4)
    rings = [k for k in range(60) if width / 2 - k * step > corner and height / 2 - k * step > corner][::-1][:12]
    for k in rings:
        a, b, c = width / 2 - k * step, height / 2 - k * step, min(corner, 0.9 * min(width / 2 - k * step, height / 2 - k * step))
        w.go(a, -b + c)
        w.go(a, b - c)
        for (cx, cy), (lx, ly) in (((a - c, b - c), (-a + c, b)), ((-a + c, b - c), (-a, -b + c)),
                                   ((-a + c, -b + c), (a - c, -b)), ((a - c, -b + c), (a, 0))):
            w.arc((cx, cy), math.pi / 2)
            w.go(lx, ly)


def adaptive(w, r):
    heading, kink = 0.0, r.choice((0.0, 0.001, 0.01, 0.05))
    for _ in range(90):
        heading = w.turn_by(heading, math.exp(r.uniform(math.log(0.5), math.log(20))), r.uniform(0.1, 1.2) * r.choice((-1, 1, 1)))
        heading += r.uniform(-kink, kink)
        if r.random() < 0.2:
            w.along(heading, r.uniform(0.2, 4))


def trochoid(w, r):
    radius, step = r.uniform(1, 5), r.uniform(0.2, 1.0)
    for k in range(25):
        x = k * step
        w.go(x, -radius)
        w.arc((x, 0), math.pi)
        w.arc((x, 0), math.pi)
        w.go(x + step, -radius)


def trochoid_d(w, r):
    """D-shaped: half circles through the material, straight back."""
    radius, step = r.uniform(1, 5), r.uniform(0.2, 1.0)
    w.go(0, -radius)
    for k in range(25):
        w.arc((k * step, 0), math.pi)
        w.go((k + 0.5) * step, radius)
        w.go((k + 1) * step, -radius)


def text(w, r):
    size = r.uniform(1.5, 8)
    for n in range(14):
        x0 = n * size * 0.8
        w.rapid(x0 + r.uniform(0, 0.5) * size, r.uniform(0, 1) * size)
        w.go(z=-0.2)
        for _ in range(r.randint(2, 6)):
            if r.random() < 0.5:
                w.go(x0 + r.uniform(0, 0.6) * size, r.uniform(0, 1) * size)
            else:
                w.turn_by(r.choice((0, 0.5, 1, 1.5)) * math.pi, r.uniform(0.1, 0.4) * size, r.choice((-1, 1)) * r.uniform(0.8, 3.2))
        w.rapid(z=1)


def script(w, r):
    """Handwriting: chords of 0.1 to 0.5 mm with rounding."""
    s, f = 0.0, [r.uniform(0.5, 1.2), r.uniform(1.0, 2.0)]
    step = r.uniform(0.1, 0.5)
    while s < 120 * step * 2:
        s += step * r.uniform(0.6, 1.4)
        w.go(0.4 * s + 1.5 * math.sin(f[0] * s), 2 * math.sin(f[0] * s + 1.2) + 0.6 * math.cos(f[1] * s))


def carve(w, r):
    """V-carving: along strokes, up in the corners."""
    heading = 0.0
    for _ in range(60):
        length, depth = r.uniform(0.5, 5), r.uniform(0.2, 2)
        steps = r.randint(1, 6)
        for k in range(1, steps + 1):
            w.along(heading, length / steps, -depth * math.sin(math.pi * k / steps) - 0.1)
        heading += r.choice((0.3, 0.8, 1.57, 2.2, -0.5, -1.57))


def drilling(w, r):
    w.rapid(z=5)
    pitch = r.uniform(3, 20)
    w.drill([(pitch * i, pitch * j if i % 2 == 0 else pitch * (3 - j)) for i in range(4) for j in range(4)],
            -r.uniform(1, 4), 1.0, r.choice((81, 81, 83)), r.uniform(0.6, 2))


def bore(w, r):
    for k in range(3):
        radius, pitch = r.uniform(0.8, 8), r.uniform(0.1, 1)
        w.rapid(k * 20 + radius, 0)
        w.rapid(z=0.5)
        turns = max(2, int(40 / (radius * 6.28)) + 1)
        if r.random() < 0.5:
            w.arc((k * 20, 0), 2 * math.pi * turns, -pitch * turns)
        else:
            for _ in range(turns):
                w.arc((k * 20, 0), math.pi, -pitch / 2)
                w.arc((k * 20, 0), math.pi, -pitch / 2)
        w.arc((k * 20, 0), 2 * math.pi)
        w.go(k * 20, 0)
        w.rapid(z=2)


def finishing(w, r):
    """Rows over a surface, chords within a tolerance, a step over at each end."""
    wave, high, step, over = r.uniform(5, 25), r.uniform(0.5, 3), r.uniform(0.2, 1.5), r.uniform(0.2, 1)
    x, y, way, length = 0.0, 0.0, 1, r.uniform(15, 40)
    while len(w.moves) < 260:
        x += way * step * r.uniform(0.5, 1.5)
        over_end = x > length or x < 0
        x = min(max(x, 0.0), length)
        z = high * math.sin(2 * math.pi * x / wave + 0.1 * y) * math.cos(y / wave)
        w.go(x, y, z)
        if over_end:
            way, y = -way, y + over
            w.go(x, y, high * math.sin(2 * math.pi * x / wave + 0.1 * y) * math.cos(y / wave))


def contour(w, r):
    """Lead-in arc, a contour of lines and tangent arcs, lead-out; at several depths."""
    side, lead = r.uniform(8, 30), r.uniform(0.5, 4)
    fillets = [r.uniform(0.3, side / 3) for _ in range(4)]
    for depth in (1, 2):
        w.rapid(-2 * lead, -lead)
        w.rapid(z=1)
        w.go(z=-depth)
        w.go(-lead, -lead)
        w.arc((-lead, 0), math.pi / 2)
        heading = math.pi / 2
        for n in range(4):
            w.along(heading, side if n else side / 2)
            heading = w.turn_by(heading, fillets[n], -math.pi / 2)
        w.go(0, 0)
        w.arc((-lead, 0), math.pi / 2)
        w.rapid(z=5)


def joints(w, r):
    """Lines that join arcs at small angles."""
    heading = 0.0
    for _ in range(40):
        w.along(heading, math.exp(r.uniform(math.log(0.5), math.log(20))))
        heading += r.uniform(-0.3, 0.3)
        heading = w.turn_by(heading, math.exp(r.uniform(math.log(0.5), math.log(10))), r.choice((-1, 1)) * r.uniform(0.2, 2.5))
        heading += r.uniform(-0.3, 0.3)


def spiral(w, r):
    """Facing outwards: half circles that grow, or chords."""
    step = r.uniform(0.3, 2)
    if r.random() < 0.5:
        way, centre = 1, 0.0
        for k in range(1, 20):
            w.arc((w.at[0] - way * k * step / 2, 0), math.pi)
            way = -way
    else:
        angle, chord = 2.0, r.uniform(0.3, 2)
        while len(w.moves) < 200:
            radius = step * angle / 6.28
            w.go(radius * math.cos(angle), radius * math.sin(angle))
            angle += min(0.6, chord / max(radius, 0.1))


def other_planes(w, r):
    for plane in (18, 19, 18, 19):
        w.select(plane)
        heading = 0.3
        for _ in range(10):
            w.along(heading, r.uniform(0.5, 6))
            heading = w.turn_by(heading + r.choice((0, 0.05)), r.uniform(0.5, 8), r.choice((-1, 1)) * r.uniform(0.3, 2.5), r.choice((0, 0.5)))
        w.select(17)
        w.rapid(0, 0, 0)


def long_short(w, r):
    """Long moves with a short one between them."""
    heading = 0.0
    for k in range(24):
        w.along(heading, r.uniform(8, 40))
        turn = r.choice((0.2, 0.8, 1.57, 2.4, 3.0)) * (-1 if k % 2 else 1)
        heading += turn / 2
        w.along(heading, math.exp(r.uniform(math.log(0.01), math.log(1.5))))
        heading += turn / 2


def rapids(w, r):
    """Rapid corners between feed moves."""
    for _ in range(15):
        x, y = r.uniform(-30, 30), r.uniform(-30, 30)
        w.rapid(x, y)
        w.rapid(z=1)
        w.go(z=-1)
        w.along(r.uniform(0, 6.28), r.uniform(1, 12))
        w.along(r.uniform(0, 6.28), r.uniform(1, 12))
        w.rapid(z=5)


def rapid_path(w, r):
    for k in range(40):
        w.rapid(w.at[0] + r.uniform(-15, 20), w.at[1] + r.uniform(-15, 15), r.choice((None, None, r.uniform(0, 8))))


def facing(w, r):
    length, over = r.uniform(20, 50), r.uniform(1, 6)
    for k in range(16):
        way = 1 if k % 2 == 0 else -1
        w.go(length if way > 0 else 0)
        w.arc((w.at[0], w.at[1] + over / 2), way * math.pi)


def chamfers(w, r):
    heading = 0.0
    size = r.uniform(3, 25)
    for _ in range(36):
        w.along(heading, size * r.uniform(0.5, 1.5))
        heading += math.pi / 4
        w.along(heading, math.exp(r.uniform(math.log(0.1), math.log(2))))
        heading += math.pi / 4


def rounded_polygon(w, r):
    heading, sign = 0.0, 1
    radius = math.exp(r.uniform(math.log(0.02), math.log(1)))
    for _ in range(50):
        w.along(heading, r.uniform(1, 12))
        if r.random() < 0.3:
            sign = -sign
        heading = w.turn_by(heading, radius, sign * r.choice((0.5, 1.0, 1.5708, 2.2)))


def chords(w, r):
    """Circles in chords within 0.002 to 0.05 mm."""
    for _ in range(4):
        radius, within = math.exp(r.uniform(math.log(1.5), math.log(25))), math.exp(r.uniform(math.log(0.002), math.log(0.05)))
        n = max(12, int(2 * math.pi / (2 * math.acos(1 - within / radius))))
        n = min(n, 200)
        x, y = w.at[0] - radius, w.at[1]
        for k in range(1, n + 1):
            w.go(x + radius * math.cos(2 * math.pi * k / n), y + radius * math.sin(2 * math.pi * k / n))
        w.go(w.at[0] + 3)


def star(w, r):
    points, big, small = r.randint(5, 12), r.uniform(5, 25), r.uniform(0.2, 0.8)
    for _ in range(3):
        for k in range(2 * points):
            radius = big * (small if k % 2 else 1)
            w.go(radius * math.cos(math.pi * k / points) - big, radius * math.sin(math.pi * k / points))


def stairs(w, r):
    step, rise = math.exp(r.uniform(math.log(0.2), math.log(4))), math.exp(r.uniform(math.log(0.2), math.log(4)))
    for _ in range(60):
        w.go(w.at[0] + step)
        w.go(None, w.at[1] + rise)


def gear(w, r):
    teeth, module = r.randint(12, 30), r.uniform(0.5, 2)
    outer, root = module * (teeth + 2) / 2, module * (teeth - 2.5) / 2
    w.go(root)
    pitch = 2 * math.pi / teeth
    for k in range(min(teeth, 16)):
        base = k * pitch
        for share, radius in ((0.18, root), (0.24, root + 0.3 * (outer - root)), (0.29, root + 0.65 * (outer - root)), (0.36, outer)):
            w.go(radius * math.cos(base + share * pitch), radius * math.sin(base + share * pitch))
        w.arc((0, 0), 0.28 * pitch)
        for share, radius in ((0.71, root + 0.65 * (outer - root)), (0.76, root + 0.3 * (outer - root)), (0.82, root)):
            w.go(radius * math.cos(base + share * pitch), radius * math.sin(base + share * pitch))
        w.arc((0, 0), 0.18 * pitch)


def raster(w, r):
    """Infill: long lines, short steps between them."""
    length, over = r.uniform(3, 40), r.uniform(0.1, 0.8)
    for k in range(40):
        w.go(length if k % 2 == 0 else 0)
        w.go(None, w.at[1] + over)


def ramping(w, r):
    """Down a slot in a zigzag."""
    length, down = r.uniform(4, 25), r.uniform(0.1, 0.6)
    for k in range(24):
        w.go(length if k % 2 == 0 else 0, None, w.at[2] - down)
    w.go(length if w.at[0] == 0 else 0)


def waves(w, r):
    """Smooth curve in chords of 0.5 to 3 mm."""
    step, wave = r.uniform(0.5, 3), r.uniform(8, 40)
    for _ in range(150):
        x = w.at[0] + step * r.uniform(0.7, 1.3)
        w.go(x, 0.2 * wave * math.sin(2 * math.pi * x / wave))


def walk(w, r):
    heading = 0.0
    kink, size = r.choice((0.1, 0.3, 0.8, 1.5)), math.exp(r.uniform(math.log(0.3), math.log(6)))
    for _ in range(120):
        w.along(heading, size * r.uniform(0.5, 1.5))
        heading += r.uniform(-kink, kink)


def feeds(w, r):
    heading = 0.0
    for _ in range(80):
        w.set_feed(r.choice((600, 1500, 2400, 3600, 6000)))
        if r.random() < 0.5:
            w.along(heading, r.uniform(0.3, 5))
        else:
            heading = w.turn_by(heading, r.uniform(1, 15), r.choice((-1, 1)) * r.uniform(0.1, 0.8))


def wrapped(w, r):
    """Engraved round a shaft: X and A."""
    x, a = 0.0, 0.0
    for k in range(80):
        x += r.uniform(-1, 2)
        a += r.uniform(-4, 6)
        w.go(x, None, -0.3 if k % 7 else 1, a)


def wrapped_curve(w, r):
    for k in range(1, 200):
        t = k * 0.08
        w.go(6 * math.sin(0.7 * t) + 0.5 * t, None, -0.2 * math.sin(2 * t), 20 * math.sin(t))


def lathe_like(w, r):
    """Roughing in XZ with fillets."""
    w.select(18)
    for k in range(6):
        w.rapid(10 - k, None, 2)
        w.go(None, None, -12 + k)
        w.turn_by(-math.pi, r.uniform(0.5, 2), r.choice((-1, 1)) * math.pi / 2)
        w.along(r.choice((-1, 1)) * math.pi / 2, 1.5)
        w.rapid(12 - k)
        w.rapid(None, None, 2)
    w.select(17)


def arcs_small(w, r):
    """Arcs about the size of the blends."""
    heading = 0.0
    for _ in range(100):
        heading = w.turn_by(heading, math.exp(r.uniform(math.log(0.1), math.log(2))), r.choice((-1, 1)) * r.uniform(0.4, 3)) + r.uniform(-0.6, 0.6)


def fillet_arcs(w, r):
    """Arcs with tiny lines between them, as fitted by CAM."""
    heading = 0.0
    for _ in range(80):
        heading = w.turn_by(heading, r.uniform(2, 12), r.choice((-1, 1)) * r.uniform(0.05, 0.6)) + r.uniform(-0.02, 0.02)
        w.along(heading, math.exp(r.uniform(math.log(0.005), math.log(0.5))))
        heading += r.uniform(-0.02, 0.02)


def slots(w, r):
    for k in range(6):
        w.rapid(k * 6, 0)
        w.rapid(z=0.5)
        w.go(z=-0.5)
        w.go(None, 15)
        w.arc((w.at[0] + 1.5, w.at[1]), -math.pi)
        w.go(None, 0)
        w.arc((w.at[0] - 1.5, w.at[1]), -math.pi)
        w.rapid(z=5)


# ---- the benchmark's families at other parameters


def arc_spiral(w, r):
    """A spiral of short arcs that bulge outwards or to both sides."""
    radius, both = r.uniform(2, 8), r.random() < 0.5
    chord, angle, out = r.uniform(0.5, 1.6) * radius, 0.0, r.uniform(6, 12)
    w.go(out, 0)
    for _ in range(160):
        angle += chord / out
        out += chord * 0.3 / 6.28
        dx, dy = out * math.cos(angle) - w.at[0], out * math.sin(angle) - w.at[1]
        length = math.hypot(dx, dy)
        if length >= 2 * radius:
            continue
        high = math.sqrt(radius * radius - length * length / 4)
        side = r.choice((1, 1, 1, -1)) if both else 1
        w.arc((w.at[0] + dx / 2 - side * high * dy / length, w.at[1] + dy / 2 + side * high * dx / length), 2 * side * math.asin(length / 2 / radius))


def arc_row(w, r):
    heading, kink = 0.0, r.choice((0.0, 0.5))
    for _ in range(120):
        heading = w.turn_by(heading, r.uniform(2, 8), r.uniform(0.2, 1.2) * r.choice((1, 1, -1))) + r.uniform(-kink, kink)


def zigzag(w, r):
    length, turn = r.choice((3, 5, 10, 20)), math.radians(r.uniform(10, 160))
    for k in range(40):
        w.along(0.0 if k % 2 == 0 else turn, length)


def helix(w, r):
    radius, pitch, chords = r.uniform(2, 8), r.uniform(0.5, 4), r.choice((0, 12, 24, 60))
    w.go(radius, 0)
    for k in range(1, 5 * chords):
        w.go(radius * math.cos(2 * math.pi * k / chords), radius * math.sin(2 * math.pi * k / chords), pitch * k / chords)
    for _ in range(0 if chords else 30):
        w.arc((0, 0), math.pi / 2, pitch / 4)


def helical_arcs(w, r):
    heading = 0.0
    for _ in range(80):
        heading = w.turn_by(heading, r.uniform(2, 8), r.uniform(0.3, 1.6) * r.choice((1, 1, -1)), r.uniform(-0.5, 0.5)) + r.uniform(-0.4, 0.4)


def four_axes(w, r):
    heading, a, wild = 0.0, 0.0, r.random() < 0.5
    for k in range(1, 150):
        if wild:
            heading += r.uniform(-0.7, 0.7)
            length, a = r.uniform(0.5, 5), a + r.uniform(-4, 6)
            w.go(w.at[0] + length * math.cos(heading), w.at[1] + length * math.sin(heading), w.at[2] + r.uniform(-0.3, 0.3), a)
        else:
            t = k * 0.08
            w.go(12 * math.sin(0.6 * t) + t, 8 * math.cos(t), 1.5 * math.sin(2 * t), 25 * math.sin(0.5 * t))


def four_axes_in_time(w, r):
    w.inverse_time = True
    w.lines.append("G93")
    four_axes(w, r)


def mixture(w, r):
    heading = 0.0
    for _ in range(150):
        kind = r.random()
        if kind < 0.5:
            w.along(heading, math.exp(r.uniform(math.log(0.05), math.log(15))), w.at[2] + r.choice((0, 0, r.uniform(-1, 1))))
        elif kind < 0.9:
            heading = w.turn_by(heading, math.exp(r.uniform(math.log(0.3), math.log(30))), r.choice((-1, 1)) * r.uniform(0.1, 3))
        else:
            w.go(z=w.at[2] + r.uniform(-1, 1))
        heading += r.choice((0, 0, r.uniform(-0.3, 0.3), r.uniform(-3, 3)))


def freeform(w, r):
    f, high, s = [r.uniform(0.1, 2) for _ in range(3)], r.uniform(1, 6), 0.0
    for _ in range(900):
        s += r.uniform(0.05, 0.2)
        w.go(s * 0.7, high * math.sin(f[0] * s), high / 3 * math.sin(f[1] * s) * math.cos(f[2] * s))


def hilbert(w, r):
    step, way, turns = r.choice((0.5, 1, 2, 4)), 0, "L"
    for _ in range(4):
        turns = "".join({"L": "+RF-LFL-FR+", "R": "-LF+RFR+FL-"}.get(c, c) for c in turns)
    for c in turns:
        way += {"+": 1, "-": 3}.get(c, 0)
        if c == "F":
            w.along(way * math.pi / 2, step)


KINDS = (pocket, adaptive, trochoid, trochoid_d, text, script, carve, drilling, bore, finishing, contour, joints, spiral, other_planes, long_short,
         rapids, rapid_path, facing, chamfers, rounded_polygon, chords, star, stairs, gear, raster, ramping, waves, walk, feeds, wrapped, wrapped_curve,
         lathe_like, arcs_small, fillet_arcs, slots, arc_spiral, arc_row, zigzag, helix, helical_arcs, four_axes, four_axes_in_time, mixture, freeform,
         hilbert)
TOLERANCES = (0.002, 0.01, 0.01, 0.02, 0.05, 0.05, 0.1, 0.2, 1.0)
FEEDS = (2400, 4800, 6000, 6000, 9000, 12000)


def programs(seed, variants=1):
    """Each kind some times, with tolerances, feeds, units and merging at random."""
    out = []
    for kind in KINDS:
        for n in range(variants):
            r = random.Random(f"{seed} {kind.__name__} {n}")
            p, feed, inch = r.choice(TOLERANCES), r.choice(FEEDS), r.random() < 0.15
            mode, unit = "G64", 25.4 if inch else 1.0
            if r.random() < 0.1:
                mode, p = "G61", 0.0
            else:
                mode = f"G64 P{p / unit:.6f}" + r.choice(("", "", " Q0", f" Q{p / unit / 2:.6f}"))
            w = Writer(f"{kind.__name__} {n} P{p:g}", mode, p, feed, 5 if inch else r.choice((3, 4)), inch)
            kind(w, r)
            out.append(w)
    return out
