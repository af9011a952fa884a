"""The small HAL programs (src/clients/hal_tools) on a running HAL."""
import importlib.util
import os
import pathlib
import subprocess
import tempfile
import unittest

BUILD = pathlib.Path(os.environ["KERF_BUILD_DIR"]).resolve()
BIN = BUILD / "bin"
SCRIPT = """loadrt threads name1=t period1=1000000
loadrt and2 count=2
loadrt sum2
net gate and2.0.out and2.1.in0
net lonely sum2.0.in0
addf and2.0 t
addf sum2.0 t
setp sum2.0.in1 2.5
start
"""


class HalTools(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.env = {**os.environ, "KERF_INSTANCE": f"hal-tools-{os.getpid()}", "PYTHONDONTWRITEBYTECODE": "1"}
        for name in ("DISPLAY", "KERF_RUN_ID", "EDITOR"):
            cls.env.pop(name, None)
        cls.host = subprocess.Popen([BIN / "rtapi_app"], env=cls.env, stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        cls.addClassCleanup(cls.host.wait)
        cls.addClassCleanup(cls.host.terminate)
        for _ in range(500):
            if cls.run_program("halcmd", "-Q", "unlock", "all").returncode == 0:
                break
            try:
                cls.host.wait(0.02)
            except subprocess.TimeoutExpired:
                pass
        with tempfile.NamedTemporaryFile("w", suffix=".hal") as file:
            file.write(SCRIPT)
            file.flush()
            done = cls.run_program("halcmd", "-f", file.name)
        assert done.returncode == 0, done.stderr

    @classmethod
    def run_program(cls, name, *words, given=""):
        return subprocess.run([BIN / name, *words], env=cls.env, input=given, capture_output=True, text=True, timeout=60, check=False)

    def good(self, name, *words, given=""):
        done = self.run_program(name, *words, given=given)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def refused(self, text, name, *words):
        done = self.run_program(name, *words)
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertIn(text, done.stderr)

    def test_halmeter_shows_values(self):
        self.assertEqual(self.good("halmeter", "-n", "1", "pin", "sum2.0.out", "sig", "gate"), "sum2.0.out 2.5  gate FALSE\n")
        self.assertEqual(self.good("halmeter", "-s", "-n", "3", "-i", "0.01", "-g", "1", "2", "param", "sum2.0.gain0"), "1\n")
        self.refused("pin 'sum2.0.nothing' not found", "halmeter", "pin", "sum2.0.nothing")
        self.refused("expected pin, sig or param", "halmeter", "sum2.0.out")

    def test_sim_pin_sets_what_may_be_set(self):
        out = self.good("sim_pin", "and2.0.in0", "sum2.0.gain1", "lonely", given="1\n2=4\n3=1.5\n2 reset\n1\n")
        self.assertEqual(out.split("\n")[3:-1], ["1  and2.0.in0  TRUE", "2  sum2.0.gain1  4", "3  lonely  1.5", "2  sum2.0.gain1  1",
                                                 "1  and2.0.in0  FALSE"])
        if importlib.util.find_spec("tkinter"):
            self.assertIn("lonely  2.5\n", self.good("sim_pin", "lonely", given="1=10/4.0\n"))
        self.good("sim_pin", "lonely", given="1=0\n")
        self.assertEqual(self.good("sim_pin", "and2.0.in1/mode=pulse", given="1\n").split("\n")[-2], "1  and2.0.in1  FALSE")
        self.refused("it is an output", "sim_pin", "and2.0.out")
        self.refused("and2.0.out writes its signal", "sim_pin", "and2.1.in0")
        self.refused("the mode is pulse, toggle or hold", "sim_pin", "and2.0.in1/mode=push")

    def test_simulate_probe_ends_untouched(self):
        self.assertEqual(self.good("simulate_probe", "--pin", "and2.1.in1", given="on\n"), "and2.1.in1 TRUE\n")
        self.assertEqual(self.good("halcmd", "getp", "and2.1.in1").strip(), "FALSE")
        self.refused("motion.probe-input", "simulate_probe")

    def test_halreport_names_functions_and_what_is_forgotten(self):
        out = self.good("halreport")
        for line in ("    1. and2.0", "    from and2.0.out: and2.0 in t", "    to   and2.1.in0: and2.1, which is in no thread",
                     "  signal lonely has no writer", "  function and2.1 is in no thread"):
            self.assertIn(line + "\n", out)
        self.assertNotIn("and2.0 is in no thread", out)

    def test_hal_histogram_counts_and_leaves_nothing(self):
        before = self.good("halcmd", "-s", "show", "comp").count("RT")
        out = self.good("hal-histogram", "--duration", "0.3", "--nbins", "4", "sum2.0.out").split("\n")
        counts = {line.split()[0]: int(line.split()[1]) for line in out[:6]}
        self.assertGreater(counts["2"], 20)
        self.assertEqual(sum(counts.values()), counts["2"])
        self.assertIn("min 2.5  max 2.5", out[6])
        self.assertEqual(self.good("halcmd", "-s", "show", "comp").count("RT"), before)
        self.assertNotIn("histogram", self.good("halcmd", "list", "sig"))

    def test_latency_programs_measure_in_a_hal_of_their_own(self):
        out = self.good("latency-test", "--virtual", "--duration", "0.2", "100us", "1ms").split("\n")
        self.assertEqual([line.split()[:2] for line in out[1:3]], [["base", "100000"], ["servo", "1000000"]])
        self.assertEqual(out[2].split()[2], "0", "on virtual time nothing is late")
        out = self.good("latency-histogram", "--virtual", "--nobase", "--sbins", "3", "--duration", "0.2", "--show")
        self.assertIn("servo thread: lateness [ns], count", out)
        self.assertRegex(out, r"(?m)^ +0 +\d+ #+$")
        self.refused("is no time", "latency-test", "soon")
        # One period is that of a servo thread; of two the shorter is the base thread's; below 1000 they are microseconds.
        out = self.good("latency-test", "--virtual", "--duration", "0.2", "2ms").split("\n")
        self.assertEqual([line.split()[:2] for line in out[1:] if line], [["servo", "2000000"]])
        out = self.good("latency-test", "--virtual", "--duration", "0.2", "0.001s", "200").split("\n")
        self.assertEqual([line.split()[:2] for line in out[1:3]], [["base", "200000"], ["servo", "1000000"]])
        self.refused("at least 5000", "latency-histogram", "--base", "10")

    def test_info_and_debuglevel(self):
        self.assertIn("HAL\n", self.good("linuxcnc_info", "-o", "-"))
        self.assertIn("interp-list", self.good("debuglevel", "--list"))
        self.refused("is no flag", "debuglevel", "+nothing")


if __name__ == "__main__":
    unittest.main()
