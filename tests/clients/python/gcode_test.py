#!/usr/bin/python3
"""gcode.parse and its helpers; no machine runs."""
import math
import os
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.environ["KERF_BUILD_DIR"], "python"))
os.environ["KERF_INSTANCE"] = "nobody%d" % os.getpid()

import gcode
import linuxcnc
import rs274.interpret


class Canon:
    """Keeps its calls."""

    def __init__(self, units=1.0, tools=()):
        self.calls, self.lines, self.units, self.tools = [], [], units, dict(tools)
        self.parameter_file = None

    def next_line(self, code):
        self.lines.append((code.sequence_number, code.motion_mode, code.gcodes))

    def get_external_length_units(self):
        return self.units

    def get_external_angular_units(self):
        return 1.0

    def get_axis_mask(self):
        return 7

    def get_block_delete(self):
        return True

    def check_abort(self):
        return False

    def get_tool(self, slot):
        return self.tools.get(slot, rs274.interpret.empty_spindle_data)

    def __getattr__(self, name):
        if name.startswith("_") or name == "use_move_batches":
            raise AttributeError(name)
        return lambda *args: self.calls.append((name,) + tuple(round(a, 5) if isinstance(a, float) else a for a in args))


def parse(text, canon=None, *codes):
    with tempfile.NamedTemporaryFile("w", suffix=".ngc", delete=False) as f:
        f.write(text)
    canon = canon or Canon()
    try:
        return gcode.parse(f.name, canon, *codes), canon
    finally:
        os.unlink(f.name)


def moves(canon, *names):
    return [call for call in canon.calls if call[0] in (names or ("straight_traverse", "straight_feed", "arc_feed"))]


class Parse(unittest.TestCase):
    def test_a_program_in_mm_comes_in_inches(self):
        (result, line), canon = parse("G21 G90\n(a comment)\n(MSG,hi there)\nF254\nG0 X25.4\nG1 X50.8\n"
                                      "G2 X50.8 Y10.16 I0 J5.08\nG18\nG4 P1.5\nM100 P3 Q4\nM2\n")
        self.assertEqual(result, 1)
        self.assertEqual(canon.calls[:3], [("set_g5x_offset", 1) + (0.0,) * 9, ("set_g92_offset",) + (0.0,) * 9,
                                           ("set_xy_rotation", 0.0)])
        self.assertEqual(moves(canon), [
            ("straight_traverse", 1.0) + (0.0,) * 8,
            ("straight_feed", 2.0) + (0.0,) * 8,
            ("arc_feed", 2.0, 0.4, 2.0, 0.2, -1, 0.0) + (0.0,) * 6])
        for call in (("comment", "a comment"), ("message", "hi there"), ("set_feed_rate", 10.0), ("dwell", 1.5),
                     ("set_plane", 3), ("user_defined_function", 0, 3.0, 4.0)):
            self.assertIn(call, canon.calls)
        lines = [n for n, _, _ in canon.lines]
        self.assertEqual(lines, sorted(lines))
        self.assertTrue(set(range(2, 11)) <= set(lines), lines)

    def test_codes_first(self):
        _, canon = parse("G0 X1\nM2\n", None, "G21", "G0 X25.4")
        self.assertEqual([m[1] for m in moves(canon)], [1.0, round(1 / 25.4, 5)])
        _, canon = parse("G0 X1\nM2\n")
        self.assertEqual([m[1] for m in moves(canon)], [1.0], "without a word programs are in inches")

    def test_a_list_of_blocks_sets_the_state_before_the_file(self):
        result, canon = parse("G1 X25.4 F100\nM2\n", None, ["G21", "g90", "t0 m6", "G53 G0 X0", "M5", "M0"], "")
        self.assertEqual(result[0], 1)
        self.assertAlmostEqual(moves(canon, "straight_feed")[-1][1], 1.0)
        self.assertGreater(parse("M2\n", None, ["G21", "bad"])[0][0], gcode.MIN_ERROR)
        self.assertRaises(TypeError, parse, "M2\n", None, ("G21",))

    def test_errors(self):
        (result, line), _ = parse("G0 X1\nG1 X2\n")
        self.assertEqual((result, line), (5, 3))
        self.assertEqual(gcode.strerror(result), "File ended with no percent sign (%) or program end (M2)")
        (result, line), _ = parse("G0 X1\nG0 G1 X2\nM2\n")
        self.assertEqual((result, line), (5, 2))
        self.assertEqual(gcode.strerror(5), "Two g codes used from same modal group")
        self.assertGreater(5, gcode.MIN_ERROR)
        self.assertEqual(gcode.parse("/nonexistent.ngc", Canon())[0], 4)
        self.assertEqual(gcode.strerror(4), "File not open")
        self.assertEqual(gcode.strerror(99), "")

    def test_percent_ends_a_file(self):
        (result, _), canon = parse("%\nG0 X1\n%\n")
        self.assertEqual((result, len(moves(canon))), (3, 1))

    def test_tools_and_offsets(self):
        tool = (7, 0.0, 0.0, 25.4) + (0.0,) * 6 + (6.0, 10.0, 20.0, 3)
        _, canon = parse("T7 M6\nG43\nG10 L2 P1 X1 R30\nG92 X5\nM2\n", Canon(tools={3: tool}))
        self.assertIn(("change_tool", 3), canon.calls)
        self.assertIn(("tool_offset", 0.0, 0.0, 1.0) + (0.0,) * 6, canon.calls)
        self.assertIn(("set_xy_rotation", 30.0), canon.calls)
        self.assertIn(("set_g5x_offset", 1, 1.0) + (0.0,) * 8, canon.calls)

    def test_a_canon_that_raises_or_stops(self):
        class Raises(Canon):
            def straight_feed(self, *args):
                raise KeyError("mine")

        with self.assertRaises(KeyError):
            parse("F10\nG1 X1\nM2\n", Raises())

        class Stops(Canon):
            def check_abort(self):
                return True

        (result, _), canon = parse("G0 X1\n" * 5000 + "M2\n", Stops())
        self.assertLess(result, gcode.MIN_ERROR)
        self.assertLess(len(moves(canon)), 5000)

    def test_probes_subs_and_block_delete(self):
        (result, _), canon = parse("o<s> sub\nG0 Y1\no<s> endsub\nF10\nG38.2 Z-1\n/G0 X9\no<s> call\no<s> call\nM2\n")
        self.assertEqual(result, 1)
        self.assertEqual(len(moves(canon, "straight_probe")), 1)
        self.assertEqual(len(moves(canon)), 2)


class Helpers(unittest.TestCase):
    class Arcs(rs274.interpret.Translated, rs274.interpret.ArcsToSegmentsMixin):
        lo = (0.0,) * 9

    def test_a_full_turn_comes_back(self):
        canon = self.Arcs()
        points = gcode.arc_to_segments(canon, 0.0, 0.0, 1.0, 0.0, 1, 0.5, 0, 0, 0, 0, 0, 0, 64)
        self.assertEqual(len(points), 64)
        for x, y in ((p[0], p[1]) for p in points):
            self.assertAlmostEqual(math.hypot(x - 1, y), 1)
        self.assertAlmostEqual(points[31][0], 2)
        self.assertAlmostEqual(points[-1][0], 0)
        self.assertAlmostEqual(points[-1][2], 0.5)

    def test_offsets_and_rotation(self):
        canon = self.Arcs()
        canon.set_g5x_offset(1, 10, 0, 0, 0, 0, 0, 0, 0, 0)
        canon.set_xy_rotation(90)
        canon.lo = (10.0,) + (0.0,) * 8
        points = gcode.arc_to_segments(canon, 1.0, 0.0, 0.5, 0.0, 1, 0.0, 0, 0, 0, 0, 0, 0, 64)
        self.assertAlmostEqual(points[-1][0], 10)
        self.assertAlmostEqual(points[-1][1], 1)
        for p in points:
            self.assertAlmostEqual(math.hypot(p[0] - 10, p[1] - 0.5), 0.5)

    def test_extents(self):
        box = gcode.calc_extents([(1, (0,) * 9, (1, 2, 3) + (0,) * 6, 10.0, (0, 0, 0.5))])
        self.assertEqual(box, ([0, 0, 0], [1, 2, 3], [0, 0, 0.5], [1, 2, 3.5]))
        self.assertEqual(gcode.calc_extents()[0], [9e99] * 3)

    def test_a_translated_point_is_a_tuple(self):
        canon = rs274.interpret.Translated()
        canon.set_g5x_offset(1, *range(9))
        canon.set_g92_offset(*[0] * 9)
        canon.set_xy_rotation(0)
        self.assertEqual(canon.rotate_and_translate(*[1] * 9), tuple(range(1, 10)))

    def test_where_axes_are_drawn(self):
        point = (1, 2, 3, 90, 0, 0, 7, 8, 9)
        self.assertEqual(linuxcnc.vertex9("XYZ", point), (1, 2, 3))
        self.assertEqual(linuxcnc.vertex9("-XYZ", point)[0], -1)
        x, y, z = linuxcnc.vertex9("AXYZ", point)
        self.assertAlmostEqual(x, 1)
        self.assertAlmostEqual(y, -3)
        self.assertAlmostEqual(z, 2)

    def test_rotations_are_about_the_work_offsets_when_asked(self):
        point = (1, 2, 3, 90, 0, 0, 7, 8, 9)
        linuxcnc.gui_rot_offsets(0, 1, 1)
        self.addCleanup(linuxcnc.gui_rot_offsets, 0, 0, 0)
        linuxcnc.gui_respect_offsets("XYZA", 0)
        self.assertAlmostEqual(linuxcnc.vertex9("AXYZ", point)[1], -3)
        linuxcnc.gui_respect_offsets("XYZA", 1)
        self.addCleanup(linuxcnc.gui_respect_offsets, "XYZA", 0)
        _, y, z = linuxcnc.vertex9("AXYZ", point)
        self.assertAlmostEqual(y, -1)
        self.assertAlmostEqual(z, 2)


class OtherParts(unittest.TestCase):
    def test_parts_of_an_installed_package_are_found_behind_ours(self):
        with tempfile.TemporaryDirectory() as folder:
            os.mkdir(os.path.join(folder, "rs274"))
            for name, text in (("__init__", ""), ("drawing", "pen = 3\n"), ("interpret", "wrong = 1\n")):
                with open(os.path.join(folder, "rs274", name + ".py"), "w", encoding="utf-8") as out:
                    out.write(text)
            script = "import rs274.drawing, rs274.interpret; print(rs274.drawing.pen, hasattr(rs274.interpret, 'wrong'))"
            path = os.pathsep.join([os.path.join(os.environ["KERF_BUILD_DIR"], "python"), folder])
            got = subprocess.run([sys.executable, "-c", script], env={**os.environ, "PYTHONPATH": path},
                                 capture_output=True, text=True, check=False)
        self.assertEqual((got.stdout, got.stderr), ("3 False\n", ""))


class NothingRuns(unittest.TestCase):
    def test_objects_are_made_and_say_that_nothing_runs(self):
        s, c, e = linuxcnc.stat(), linuxcnc.command(), linuxcnc.error_channel()
        for call in (s.poll, c.abort, e.poll):
            with self.assertRaises(linuxcnc.error):
                call()
        self.assertEqual(s.task_state, linuxcnc.STATE_ESTOP)


class Ini(unittest.TestCase):
    TEXT = ("[A]\nX = 1\nX = two\nF = 1.5\nB = yes\nU = inch\nT = ANGULAR\n[B]\nX = -3\nR = rad\n")

    def setUp(self):
        with tempfile.NamedTemporaryFile("w", suffix=".ini", delete=False) as f:
            f.write(self.TEXT)
        self.name = f.name
        self.ini = linuxcnc.ini(f.name)

    def tearDown(self):
        os.unlink(self.name)

    def test_values(self):
        i = self.ini
        self.assertEqual(i.find("A", "X"), "1")
        self.assertEqual(i.getstring("A", "X", 2), "two")
        self.assertEqual(i.getstring("A", "X", num=3, fallback="none"), "none")
        self.assertIsNone(i.find("A", "NOPE"))
        self.assertEqual(i.findall("A", "X"), ["1", "two"])
        self.assertEqual(i.getint("A", "X"), 1)
        self.assertIsNone(i.getint("A", "X", 2))
        self.assertEqual(i.getsint("B", "X"), -3)
        self.assertEqual(i.getuint("B", "X", fallback=8), 8)
        self.assertEqual(i.getfloat("A", "F"), 1.5)
        self.assertEqual(i.getreal("", "F"), 1.5)
        self.assertIs(i.getbool("A", "B"), True)
        self.assertAlmostEqual(i.getlinearunits("A", "U"), 0.03937007874015748)
        self.assertAlmostEqual(i.getangularunits("B", "R"), 0.017453292519943295)
        self.assertEqual(i.getjointtype("A", "T"), linuxcnc.ANGULAR)
        self.assertEqual(i.maplinearunits("mm"), 1.0)
        self.assertEqual(i.mapangularunits("deg"), 1.0)
        self.assertEqual(i.mapjointtype("x", fallback=5), 5)

    def test_structure(self):
        i = self.ini
        self.assertEqual(i.getsections(), ["A", "B"])
        self.assertEqual(i.getvariables("B"), [("X", "-3"), ("R", "rad")])
        self.assertTrue(i.hassection("A"))
        self.assertFalse(i.hassection("C"))
        self.assertTrue(i.hasvariable("A", "X", 2))
        self.assertFalse(i.hasvariable("A", "X", 3))
        self.assertEqual(i.lineof("A", "X", 2), (self.name, 3))
        self.assertEqual(i.lineof("A", "NOPE"), (None, None))
        with self.assertRaises(linuxcnc.error):
            i.find("A", "X", 0)
        with self.assertRaises(linuxcnc.error) as refused:
            linuxcnc.ini("/nonexistent")
        self.assertEqual(str(refused.exception), "inifile.open(/nonexistent) failed")


if __name__ == "__main__":
    unittest.main()
