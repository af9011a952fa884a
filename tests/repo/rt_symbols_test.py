"""scripts/check_rt_symbols.sh refuses an archive and a component that allocate, and passes one that only computes."""
import pathlib
import subprocess
import tempfile
import unittest

TOP = pathlib.Path(__file__).resolve().parents[2]


def run(command, **more):
    return subprocess.run(command, capture_output=True, text=True, check=False, **more)


class RtSymbols(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.dir = pathlib.Path(folder.name)

    def archive(self, code):
        (self.dir / "part.cpp").write_text(code)
        for command in (["g++", "-std=c++20", "-O1", "-fno-exceptions", "-fPIC", "-c", "part.cpp"],
                        ["ar", "rcs", "libpart.a", "part.o"]):
            made = run(command, cwd=self.dir)
            self.assertEqual(made.returncode, 0, made.stderr)
        (self.dir / "rt_archives.txt").write_text(f"{self.dir}/libpart.a\n\n")

    def audit(self):
        return run([TOP / "scripts/check_rt_symbols.sh", self.dir])

    def test_arithmetic_and_own_calls_pass(self):
        self.archive("#include <cmath>\nvoid near(double); void near(double) {}\n"
                     "double far(double x) { near(x); return std::sin(x); }")
        found = self.audit()
        self.assertEqual(found.returncode, 0, found.stderr)

    def test_allocation_in_an_archive(self):
        self.archive("int* make() { return new int[7]; }")
        found = self.audit()
        self.assertEqual(found.returncode, 1)
        self.assertIn("libpart.a(part.o): operator new[](unsigned long)", found.stderr)

    def test_stdio_in_a_component(self):
        self.archive("")
        (self.dir / "components").mkdir()
        (self.dir / "comp.cpp").write_text("#include <cstdio>\nvoid f(int x) { std::printf(\"%d\", x); }")
        made = run(["g++", "-shared", "-fPIC", "comp.cpp", "-o", "components/comp.so"], cwd=self.dir)
        self.assertEqual(made.returncode, 0, made.stderr)
        found = self.audit()
        self.assertEqual(found.returncode, 1)
        self.assertIn("components/comp.so: printf", found.stderr)

    def test_missing_archive_is_an_error(self):
        (self.dir / "rt_archives.txt").write_text(f"{self.dir}/libnone.a\n")
        found = self.audit()
        self.assertNotEqual(found.returncode, 0)
        self.assertIn("libnone.a is not built", found.stderr)


if __name__ == "__main__":
    unittest.main()
