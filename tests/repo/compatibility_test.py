"""docs/compatibility.md is what scripts/compatibility.py makes, and each name that our code declares has a verdict."""
import os
import pathlib
import subprocess
import sys
import unittest

TOP = pathlib.Path(__file__).resolve().parents[2]


BUILD = pathlib.Path(os.environ.get("KERF_BUILD_DIR", TOP / "build/dev"))


class Compatibility(unittest.TestCase):
    def test_page_and_declarations_agree(self):
        run = subprocess.run([sys.executable, TOP / "scripts/compatibility.py", "--check"], capture_output=True, text=True,
                             check=False, timeout=300)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)

    @unittest.skipUnless((BUILD / "bin/kerf").exists(), "kerf is not built")
    def test_pages_of_ini_keys_are_those_of_the_table(self):
        run = subprocess.run([sys.executable, TOP / "scripts/ini_keys.py", "--check"], capture_output=True, text=True,
                             check=False, timeout=60)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)


if __name__ == "__main__":
    unittest.main()
