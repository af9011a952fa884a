"""scripts/setup asks apt-get for what is missing and nothing else; with stand-ins for dpkg-query, apt-get and sudo."""
import os
import pathlib
import subprocess
import tempfile
import unittest

TOP = pathlib.Path(__file__).resolve().parents[2]


class Setup(unittest.TestCase):
    def run_setup(self, part, missing, apt_status=0):
        """Gives status, both outputs, and the calls of apt-get."""
        with tempfile.TemporaryDirectory() as folder:
            calls = pathlib.Path(folder, "calls")
            programs = {
                "dpkg-query": f'case " {" ".join(missing)} " in *" $3 "*) exit 1 ;; esac; echo installed',
                "apt-get": f'echo "$*" >>{calls}; case "$*" in *install*) exit {apt_status} ;; esac',
                "sudo": f'echo sudo >>{calls}; exec "$@"',
            }
            for name, code in programs.items():
                path = pathlib.Path(folder, name)
                path.write_text(f"#!/bin/sh\n{code}\n")
                path.chmod(0o755)
            out = subprocess.run([TOP / "scripts/setup", part], capture_output=True, text=True, check=False, cwd="/",
                                 env={**os.environ, "PATH": f"{folder}:{os.environ['PATH']}"})
            lines = calls.read_text().splitlines() if calls.exists() else []
            return out.returncode, out.stdout, out.stderr, lines

    def test_nothing_missing_is_silent(self):
        for part in ("run", "test", "rtvm"):
            self.assertEqual(self.run_setup(part, []), (0, "", "", []))

    def test_only_what_is_missing(self):
        status, _, _, calls = self.run_setup("test", ["ccache", "clang-tidy"])
        self.assertEqual(status, 0)
        calls = [call for call in calls if call != "sudo"]
        self.assertEqual(len(calls), 1)
        self.assertTrue(calls[0].endswith("--no-install-recommends ccache clang-tidy"), calls)

    def test_sudo_only_when_not_root(self):
        _, _, _, calls = self.run_setup("run", ["ccache"])
        self.assertEqual("sudo" in calls, os.geteuid() != 0)

    def test_run_does_not_want_the_test_packages(self):
        status, _, _, calls = self.run_setup("run", ["libgtest-dev", "qemu-system-x86", "chromium"])
        self.assertEqual((status, calls), (0, []))

    def test_failure_names_the_packages(self):
        status, _, stderr, calls = self.run_setup("run", ["ccache"], apt_status=100)
        self.assertNotEqual(status, 0)
        self.assertIn("could not install: ccache", stderr)
        # Fresh lists were fetched before giving up.
        self.assertTrue(any(call.endswith("update") for call in calls), calls)


if __name__ == "__main__":
    unittest.main()
