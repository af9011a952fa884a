"""LinuxCNC's own simulator INI files, where its package is installed, pass `kerf check`, or fail for a reason that is known."""
import os
import pathlib
import re
import subprocess
import sys
import unittest

TOP = pathlib.Path(__file__).resolve().parents[2]
KERF = pathlib.Path(os.environ.get("KERF_BUILD_DIR", TOP / "build/dev")).resolve() / "bin/kerf"
SAMPLES = pathlib.Path("/usr/share/doc/linuxcnc/examples/sample-configs/sim")
# What the messages of files that do not pass may say, and why that is right.
REASONS = {
    r"\[HAL\]\w+: no file ": "a HAL file of LinuxCNC's library that Kerf's has not",
    r"Identifier contains invalid character": "a key with '-': the newest reader refuses it as well",
    r"is defined twice; tool numbers must be unique": "the manual's rule for tool tables",
    r"Missing filename after #INCLUDE|includes_demo.*Cannot open ini-file": "a demonstration of wrong includes",
    r"Expected '=' after tag identifier": "a line without '=': the newest reader refuses it as well",
    r"\.tbl:\d+: .*: expected a ": "a tool table with a line of other text",
    r"NGC file not found: ngc=": "a sub that the folder does not have",
    r"\[KINS\]\w+ is missing|\[TRAJ\]COORDINATES is missing": "from before LinuxCNC 2.8, or not a machine by itself",
    r"no \[HAL\]HALFILE": "not a machine by itself",
}


@unittest.skipUnless(KERF.exists(), "kerf is not built")
@unittest.skipUnless(SAMPLES.is_dir(), "LinuxCNC's package is not installed")
class SimulatorFiles(unittest.TestCase):
    def test_each_passes_or_has_a_reason(self):
        passed, failed, unknown = 0, {}, []
        files = sorted(SAMPLES.rglob("*.ini"))
        self.assertGreater(len(files), 100)
        for file in files:
            run = subprocess.run([KERF, "check", file], capture_output=True, text=True, errors="replace", check=False,
                                 timeout=60, stdin=subprocess.DEVNULL)
            name = str(file.relative_to(SAMPLES))
            self.assertIn(run.returncode, (0, 1), f"{name}: {run.stderr}")
            if run.returncode == 0:
                passed += 1
                continue
            errors = [line for line in run.stderr.splitlines() if "error: " in line]
            self.assertTrue(errors, f"{name} fails without a word: {run.stderr}")
            for line in errors:
                if re.search(r"the INI file cannot be used$", line):
                    continue
                reason = next((r for pattern, r in REASONS.items() if re.search(pattern, line)), None)
                if reason is None:
                    unknown.append(f"{name}: {line}")
                else:
                    failed.setdefault(reason, set()).add(name)
        print(f"{passed} of {len(files)} pass", file=sys.stderr)
        for reason, names in failed.items():
            print(f"{len(names)} have: {reason}", file=sys.stderr)
        self.assertFalse(unknown, "\n" + "\n".join(unknown))


if __name__ == "__main__":
    unittest.main()
