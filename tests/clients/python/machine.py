"""A running machine for tests of the Python modules: a copy of machine/ with all its true processes.

    with machine.Machine() as m: ...        # m.folder, m.instance
KERF_BUILD_DIR says where the programs are.
"""
import os
import shutil
import signal
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
BUILD = os.environ["KERF_BUILD_DIR"]
sys.path.insert(0, os.path.join(BUILD, "python"))


class Machine:
    """Starts when the block is entered and is gone when it is left."""

    def __init__(self):
        self.folder = tempfile.mkdtemp(prefix="kerf-python-")
        shutil.copytree(os.path.join(HERE, "machine"), self.folder, dirs_exist_ok=True)
        self.instance = "py%d" % os.getpid()
        os.environ["KERF_INSTANCE"] = self.instance
        os.environ["KERF_TEST_FOLDER"] = self.folder
        os.environ["XDG_STATE_HOME"] = self.folder + "/state"
        self.kerf = None

    def __enter__(self):
        self.output = open(os.path.join(self.folder, "kerf.out"), "w+")
        # A pipe that nobody writes to: the machine stays until it is told to end.
        self.kerf = subprocess.Popen([os.path.join(BUILD, "bin", "kerf"), "sim.ini", "--instance", self.instance],
                                     cwd=self.folder, stdin=subprocess.PIPE, stdout=self.output,
                                     stderr=subprocess.STDOUT)
        try:
            import linuxcnc_util
            linuxcnc_util.LinuxCNC().wait_for_linuxcnc_startup(60)
        except BaseException:
            self.end()
            raise
        return self

    def __exit__(self, kind, *_):
        ended = self.kerf.poll()
        self.end()
        if kind is not None:
            print("kerf said (exit %s):\n%s" % (ended, self.said), file=sys.stderr)

    def end(self):
        if self.kerf.poll() is None:
            self.kerf.send_signal(signal.SIGTERM)
            try:
                self.kerf.wait(60)
            except subprocess.TimeoutExpired:
                self.kerf.kill()
        self.output.seek(0)
        self.said = self.output.read()
        self.output.close()
        shutil.rmtree(self.folder, ignore_errors=True)

    def power_on_and_home(self, linuxcnc, c):
        for step in (lambda: c.state(linuxcnc.STATE_ESTOP_RESET), lambda: c.state(linuxcnc.STATE_ON),
                     lambda: c.home(-1)):
            step()
            assert c.wait_complete(30) == linuxcnc.RCS_DONE
