"""docs/m-codes.md is what scripts/m_codes.py makes of the rows that have tests."""
import pathlib
import subprocess
import sys
import unittest

TOP = pathlib.Path(__file__).resolve().parents[2]


class MCodes(unittest.TestCase):
    def test_the_page_is_up_to_date(self):
        run = subprocess.run([sys.executable, TOP / "scripts/m_codes.py", "--check"], capture_output=True, text=True, check=False,
                             timeout=60)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)


if __name__ == "__main__":
    unittest.main()
