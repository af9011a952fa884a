"""The sample programs are read by our rs274 and cut what they say, M101 does too; generated pages are up to date."""
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

TOP = pathlib.Path(__file__).resolve().parents[2]
RS274 = pathlib.Path(os.environ.get("KERF_BUILD_DIR", TOP / "build/dev")).resolve() / "bin/rs274"
MDI = RS274.parent / "mdi"
MILL = TOP / "configs/sim/mill"


def run(command, **more):
    return subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False, **more)


@unittest.skipUnless(RS274.is_file(), "rs274 is not built")
class Programs(unittest.TestCase):
    def listing(self, name):
        text = (TOP / "nc_files/examples" / name).read_text()
        with tempfile.TemporaryDirectory() as folder:
            # rs274 alone runs no user M-codes: they belong to a machine.
            program = pathlib.Path(folder, name)
            program.write_text(re.sub(r"^M101.*$", "", text, flags=re.M))
            for sub in (TOP / "nc_files/subroutines").glob("*.ngc"):
                pathlib.Path(folder, sub.name).write_text(sub.read_text())
            out = run([RS274, "-g", "-t", MILL / "mill.tbl", "-i", MILL / "mill.ini", program], cwd=folder)
        self.assertEqual(out.returncode, 0, f"{name}: {out.stderr}")
        return out.stdout.splitlines()

    def test_each_runs_to_its_end(self):
        for file in sorted((TOP / "nc_files/examples").glob("*.ngc")):
            with self.subTest(file.name):
                lines = self.listing(file.name)
                self.assertTrue(any("PROGRAM_END()" in line for line in lines))
                self.assertGreater(sum("STRAIGHT_FEED" in line or "ARC_FEED" in line for line in lines), 3)

    def test_the_first_part_has_what_it_says(self):
        lines = "\n".join(self.listing("first_part.ngc"))
        self.assertEqual(len(re.findall(r"CHANGE_TOOL\(", lines)), 3)
        self.assertEqual(len(re.findall(r"MESSAGE\(", lines)), 5)
        # Four holes to Z-11.
        holes = set(re.findall(r"STRAIGHT_FEED\((\S+), (\S+), -11\.0000", lines))
        self.assertEqual(holes, {("10.0000", "10.0000"), ("80.0000", "10.0000"), ("80.0000", "50.0000"), ("10.0000", "50.0000")})
        # The pocket's floor and its outermost ring: radius 15 less the tool's 3.
        self.assertIn("ARC_FEED(57.0000, 30.0000, 45.0000, 30.0000, 1, -5.0000", lines)
        # A helix in.
        self.assertIn("ARC_FEED(49.0000, 30.0000, 45.0000, 30.0000, 1, -1.0000", lines)
        # The outline's last level.
        self.assertIn("ARC_FEED(93.0000, 52.0000, 82.0000, 52.0000, -1, -8.0000", lines)


@unittest.skipUnless(MDI.is_file(), "mdi is not built")
class GeneratedPages(unittest.TestCase):
    def test_protocol(self):
        self.assertEqual((TOP / "docs/protocol.md").read_text(), run([MDI, "--protocol"]).stdout,
                         "stale: mdi --protocol >docs/protocol.md")

    @unittest.skipUnless((MDI.parent / "hal").is_file(), "hal is not built")
    def test_components(self):
        pages = TOP / "docs/components"
        with tempfile.TemporaryDirectory() as folder:
            made = run([MDI.parent / "hal", "describe", "--all", "--markdown", "-o", folder])
            self.assertEqual(made.returncode, 0, made.stderr)
            names = {page.name for page in pathlib.Path(folder).iterdir()}
            self.assertEqual(names | {"index.md"}, {page.name for page in pages.iterdir()})
            for name in sorted(names):
                self.assertEqual((pages / name).read_text(), pathlib.Path(folder, name).read_text(),
                                 "stale: hal describe --all --markdown -o docs/components")


class UserCode(unittest.TestCase):
    def test_m101(self):
        good = run([TOP / "nc_files/M101", "1.000000", "3.000000"])
        self.assertEqual((good.returncode, good.stderr), (0, "M101: finished 1 part(s), last tool 3\n"))
        with tempfile.TemporaryDirectory() as folder:
            log = pathlib.Path(folder, "parts")
            run([TOP / "nc_files/M101", "2.000000", "1.000000"], env={**os.environ, "KERF_PART_LOG": str(log)})
            self.assertRegex(log.read_text(), r"^\d{4}-\d\d-\d\d \d\d:\d\d:\d\d 2 1\n$")
        self.assertEqual(run([TOP / "nc_files/M101", "-1.000000", "-1.000000"]).returncode, 1)


if __name__ == "__main__":
    unittest.main()
