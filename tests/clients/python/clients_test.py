#!/usr/bin/python3
"""Several Python clients at once: each gets its own outcomes, each sees every message once, and a jog ends with its client."""
import os
import random
import subprocess
import sys
import threading
import time
import unittest

import machine

import linuxcnc

CLIENTS = 8
COMMANDS = 1000
BAD = 100
SEED = 20260


class Outcomes(unittest.TestCase):
    def test_eight_clients_get_their_own_outcomes_and_every_error_once(self):
        """Bad commands name their client and number in the message that they bring."""
        dice = random.Random(SEED)
        bad = set(dice.sample(range(COMMANDS), BAD))
        plan = [[n for n in range(COMMANDS) if n % CLIENTS == k] for k in range(CLIENTS)]
        wrong, seen = [], [[] for _ in range(CLIENTS)]
        ready = threading.Barrier(CLIENTS)
        over = threading.Barrier(CLIENTS)

        def client(k):
            c, e, s = linuxcnc.command(), linuxcnc.error_channel(), linuxcnc.stat()
            mine = random.Random(SEED + k)
            ready.wait()
            for n in plan[k]:
                if n in bad:
                    # No such output: refused, and the number is in the message.
                    c.set_digital_output(1000 + n, 1)
                    expected = linuxcnc.RCS_ERROR
                else:
                    mine.choice([lambda: c.set_digital_output(mine.randrange(4), mine.randrange(2)),
                                 lambda: c.set_analog_output(mine.randrange(4), mine.random()),
                                 lambda: c.feedrate(0.5 + mine.random() / 2),
                                 lambda: c.debug(n),
                                 lambda: c.set_feed_hold(1),
                                 lambda: c.maxvel(50 + mine.random())])()
                    expected = linuxcnc.RCS_DONE
                got = c.wait_complete(30)
                if got != expected:
                    wrong.append((k, n, got, expected))
                if mine.random() < 0.1:
                    s.poll()
                self.read(e, seen[k])
            over.wait()
            self.read(e, seen[k])

        threads = [threading.Thread(target=client, args=(k,)) for k in range(CLIENTS)]
        for t in threads:
            t.start()
        for t in threads:
            t.join()
        self.assertEqual(wrong, [])
        expected = sorted("motion.digital-out-%d" % (1000 + n) for n in bad)
        for k in range(CLIENTS):
            self.assertEqual(sorted(text.split(" ")[0] for kind, text in seen[k] if kind == 11), expected, k)

    @staticmethod
    def read(channel, into):
        while True:
            message = channel.poll()
            if message is None:
                return
            into.append(message)

    def test_serials_grow_and_are_nobody_elses(self):
        a, b = linuxcnc.command(), linuxcnc.command()
        seen = []
        for _ in range(5):
            a.debug(0)
            b.debug(0)
            seen += [a.serial, b.serial]
        self.assertEqual(sorted(set(seen)), seen)
        s = linuxcnc.stat()
        a.wait_complete()
        s.poll()
        self.assertGreaterEqual(s.echo_serial_number, seen[-1])


class Waits(unittest.TestCase):
    def setUp(self):
        self.c, self.s = linuxcnc.command(), linuxcnc.stat()
        self.c.mode(linuxcnc.MODE_MDI)
        self.assertEqual(self.c.wait_complete(), linuxcnc.RCS_DONE)

    def test_wait_complete_tells_time_out_done_and_error(self):
        self.c.mdi("G4 P0.5")
        began = time.time()
        self.assertEqual(self.c.wait_complete(0.05), -1)
        self.assertEqual(self.c.wait_complete(0), -1)
        self.assertLess(time.time() - began, 0.45)
        self.assertEqual(self.c.wait_complete(20), linuxcnc.RCS_DONE)
        self.assertEqual(self.c.wait_complete(0), linuxcnc.RCS_DONE)
        self.c.mdi("G0 G1 X1")
        self.assertEqual(self.c.wait_complete(20), linuxcnc.RCS_ERROR)
        with self.assertRaises(linuxcnc.error):
            self.c.wait_complete(-1)

    def test_one_clients_wait_is_not_anothers(self):
        other = linuxcnc.command()
        self.c.mdi("G4 P1")
        other.debug(0)
        self.assertEqual(other.wait_complete(0.5), linuxcnc.RCS_DONE)
        self.assertEqual(self.c.wait_complete(0.05), -1)
        self.c.abort()
        self.assertEqual(self.c.wait_complete(20), linuxcnc.RCS_DONE)

    def test_a_thread_waits_while_another_works(self):
        done = []
        self.c.mdi("G4 P0.4")
        t = threading.Thread(target=lambda: done.append(self.c.wait_complete(20)))
        t.start()
        polls = 0
        while t.is_alive():
            self.s.poll()
            polls += 1
            time.sleep(0.001)
        t.join()
        self.assertEqual(done, [linuxcnc.RCS_DONE])
        self.assertGreater(polls, 5)


class Programs(unittest.TestCase):
    """What the program asks, what it waits for, and which way it goes."""

    def setUp(self):
        self.c, self.s = linuxcnc.command(), linuxcnc.stat()
        self.addCleanup(self.c.mode, linuxcnc.MODE_MDI)
        self.addCleanup(self.c.wait_complete)
        self.addCleanup(self.c.abort)

    def run_text(self, text):
        path = os.path.join(os.environ["KERF_TEST_FOLDER"], "asks.ngc")
        with open(path, "w", encoding="utf-8") as program:
            program.write(text)
        for step in (lambda: self.c.mode(linuxcnc.MODE_AUTO), lambda: self.c.program_open(path)):
            step()
            self.assertEqual(self.c.wait_complete(20), linuxcnc.RCS_DONE)
        self.c.auto(linuxcnc.AUTO_RUN, 0)

    def until(self, what, seconds=20):
        end = time.time() + seconds
        while time.time() < end:
            self.s.poll()
            if what():
                return
            time.sleep(0.002)
        self.fail("not within %s s: prompt %s, waits for %s, at %s" % (seconds, self.s.prompt, self.s.waiting_for, self.s.position))

    def test_the_prompt_is_answered_by_its_number(self):
        self.run_text("G21 G90\nM0\nM60\nG0 X3\nM2\n")
        self.until(lambda: self.s.prompt)
        first = self.s.prompt
        self.assertEqual((first["kind"], first["tool"]), ("stop", -1))
        self.assertEqual(self.s.waiting_for["text"], "resume")
        self.c.answer(first["number"] + 7)
        self.assertEqual(self.c.wait_complete(20), linuxcnc.RCS_ERROR)
        self.c.answer(first["number"])
        self.until(lambda: self.s.prompt and self.s.prompt["kind"] == "pallet")
        self.c.answer()
        self.until(lambda: self.s.interp_state == linuxcnc.INTERP_IDLE and self.s.prompt is None)
        self.assertIsNone(self.s.waiting_for)
        self.assertAlmostEqual(self.s.position[0], 3)

    def test_what_is_waited_for_has_its_pin(self):
        self.run_text("G21 G90\nM66 P1 L3 Q600\nM2\n")
        self.until(lambda: self.s.waiting_for)
        wait = self.s.waiting_for
        self.assertEqual((wait["object"], wait["pin"], wait["net"]), ("digital input 1", "motion.digital-in-01", ""))
        self.assertIn("not linked", wait["text"])

    STARTER = """
import linuxcnc, sys, time
c, s = linuxcnc.command(), linuxcnc.stat()
for step in (lambda: c.mode(linuxcnc.MODE_AUTO), lambda: c.program_open(sys.argv[1])):
    step(); assert c.wait_complete(20) == linuxcnc.RCS_DONE
c.auto(linuxcnc.AUTO_RUN, 0)
while not s.waiting_for or s.waiting_for["object"].find(sys.argv[2]) < 0:
    s.poll()
print("waits", flush=True)
c.wait_complete(600)
"""

    def test_a_client_that_is_killed_leaves_its_wait_to_the_others(self):
        path = os.path.join(os.environ["KERF_TEST_FOLDER"], "waits.ngc")
        for block, waits_for in (("M0", "resume"), ("M66 P1 L3 Q600", "digital input 1"), ("G4 P600", "dwell")):
            with open(path, "w", encoding="utf-8") as program:
                program.write("G21 G90\nG0 X4\n%s\nG0 X40\nM2\n" % block)
            starter = subprocess.Popen([sys.executable, "-c", self.STARTER, path, waits_for], stdout=subprocess.PIPE, text=True,
                                       env=dict(os.environ, PYTHONPATH=os.path.join(machine.BUILD, "python")))
            self.assertEqual(starter.stdout.readline().strip(), "waits")
            starter.kill()
            starter.wait()
            starter.stdout.close()
            time.sleep(0.1)
            self.s.poll()
            self.assertIn(waits_for, self.s.waiting_for["text"])
            self.assertNotEqual(self.s.interp_state, linuxcnc.INTERP_IDLE)
            self.assertAlmostEqual(self.s.position[0], 4)
            self.c.abort()
            self.assertEqual(self.c.wait_complete(20), linuxcnc.RCS_DONE)
            self.until(lambda: self.s.interp_state == linuxcnc.INTERP_IDLE and self.s.waiting_for is None)
            self.c.mode(linuxcnc.MODE_MDI)
            self.c.wait_complete(20)
            self.c.mdi("G21 G90 G0 X1")
            self.assertEqual(self.c.wait_complete(20), linuxcnc.RCS_DONE, block)
            self.s.poll()
            self.assertAlmostEqual(self.s.position[0], 1)

    def test_a_paused_program_runs_back_and_forwards_again(self):
        self.run_text("G21 G90 G61\nG0 X0\nG4 P0\nG1 X10 F1200\nG1 X20\nM2\n")
        self.until(lambda: self.s.position[0] > 12)
        self.c.auto(linuxcnc.AUTO_REVERSE)
        self.assertEqual(self.c.wait_complete(20), linuxcnc.RCS_ERROR, "it is not paused")
        self.c.auto(linuxcnc.AUTO_PAUSE)
        self.until(lambda: self.s.paused)
        self.c.auto(linuxcnc.AUTO_REVERSE)
        self.assertEqual(self.c.wait_complete(20), linuxcnc.RCS_DONE)
        self.c.auto(linuxcnc.AUTO_RESUME)
        self.until(lambda: self.s.position[0] < 5)
        self.c.auto(linuxcnc.AUTO_PAUSE)
        self.until(lambda: self.s.paused)
        self.c.auto(linuxcnc.AUTO_FORWARD)
        self.assertEqual(self.c.wait_complete(20), linuxcnc.RCS_DONE)
        self.c.auto(linuxcnc.AUTO_RESUME)
        self.until(lambda: self.s.interp_state == linuxcnc.INTERP_IDLE)
        self.assertAlmostEqual(self.s.position[0], 20)


class UserMcodes(unittest.TestCase):
    def test_abort_ends_a_script_that_sleeps_for_ever_with_its_children(self):
        folder = os.environ["KERF_TEST_FOLDER"]
        script = os.path.join(folder, "M177")
        with open(script, "w", encoding="ascii") as f:
            f.write("#!/bin/sh\necho $$ > pids\nsleep 100000 &\necho $! >> pids\nwait\n")
        os.chmod(script, 0o755)
        c, s = linuxcnc.command(), linuxcnc.stat()
        c.mode(linuxcnc.MODE_MDI)
        c.wait_complete(20)
        for _ in range(5):
            c.mdi("M177")
            pids = []
            while len(pids) < 2:
                try:
                    with open(os.path.join(folder, "pids"), encoding="ascii") as f:
                        pids = f.read().split()
                except FileNotFoundError:
                    pass
            os.remove(os.path.join(folder, "pids"))
            s.poll()
            self.assertNotEqual(s.interp_state, linuxcnc.INTERP_IDLE)
            c.abort()
            self.assertEqual(c.wait_complete(20), linuxcnc.RCS_DONE)
            s.poll()
            self.assertEqual(s.interp_state, linuxcnc.INTERP_IDLE)
            for pid in pids:
                while os.path.exists("/proc/" + pid):
                    time.sleep(0.01)
        c.mdi("G4 P0.01")
        self.assertEqual(c.wait_complete(20), linuxcnc.RCS_DONE)


class Jogs(unittest.TestCase):
    SCRIPT = """
import linuxcnc, os, sys, time
c, s = linuxcnc.command(), linuxcnc.stat()
c.mode(linuxcnc.MODE_MANUAL); c.wait_complete()
c.teleop_enable(1); c.wait_complete()
c.jog(linuxcnc.JOG_CONTINUOUS, 0, 1, 5.0)
while s.axis[1]["velocity"] < 4.9:
    s.poll()
print("moves", flush=True)
time.sleep(60)
"""

    def test_a_continuous_jog_ends_with_its_process(self):
        jogger = subprocess.Popen([sys.executable, "-c", self.SCRIPT], stdout=subprocess.PIPE, text=True,
                                  env=dict(os.environ, PYTHONPATH=os.path.join(machine.BUILD, "python")))
        s = linuxcnc.stat()
        self.assertEqual(jogger.stdout.readline().strip(), "moves")
        s.poll()
        self.assertGreater(s.axis[1]["velocity"], 4)
        jogger.kill()
        jogger.wait()
        jogger.stdout.close()
        for _ in range(2000):
            s.poll()
            if s.axis[1]["velocity"] == 0 and s.inpos:
                break
            time.sleep(0.005)
        self.assertEqual(s.axis[1]["velocity"], 0)
        self.assertLess(s.position[1], 90)

    def test_a_continuous_jog_ends_with_its_object(self):
        c, s = linuxcnc.command(), linuxcnc.stat()
        c.mode(linuxcnc.MODE_MANUAL)
        c.wait_complete()
        c.teleop_enable(1)
        c.wait_complete()
        c.jog(linuxcnc.JOG_CONTINUOUS, 0, 0, 5.0)
        while s.axis[0]["velocity"] < 4.9:
            s.poll()
        del c
        while s.axis[0]["velocity"] != 0:
            s.poll()


class Logger(unittest.TestCase):
    def test_it_remembers_the_path(self):
        c, s = linuxcnc.command(), linuxcnc.stat()
        white = (255, 255, 255, 255)
        log = linuxcnc.positionlogger(s, white, white, white, white, white, white, "XYZ")
        self.assertEqual(log.npts, 0)
        self.assertIsNone(log.last())
        t = threading.Thread(target=log.start, args=(0.002,))
        t.start()
        c.mode(linuxcnc.MODE_MDI)
        c.mdi("G21 G90 G0 X0 Y0 Z0")
        c.wait_complete(20)
        c.mdi("G1 X25.4 F3000")
        self.assertEqual(c.wait_complete(20), linuxcnc.RCS_DONE)
        time.sleep(0.1)
        log.stop()
        t.join()
        self.assertGreater(log.npts, 3)
        self.assertEqual(len(log.last(0)), 6)
        self.assertAlmostEqual(log.last(0)[0], 1.0, places=4)
        # Without an argument: what has been drawn.
        self.assertIsNone(log.last())
        log.call()
        self.assertEqual(log.last(), log.last(0))
        log.clear()
        self.assertIsNone(log.last(0))
        self.assertEqual(log.npts, 0)
        self.assertEqual(log.get_colors(), (white,) * 6)


if __name__ == "__main__":
    with machine.Machine() as m:
        m.power_on_and_home(linuxcnc, linuxcnc.command())
        program = unittest.main(exit=False)
    # The machine is gone: what scripts see then.
    s = linuxcnc.stat()
    for call in (s.poll, linuxcnc.command().abort, linuxcnc.error_channel().poll):
        try:
            call()
            sys.exit("%s did not notice that no machine runs" % call)
        except linuxcnc.error as problem:
            assert str(problem), call
    sys.exit(not program.result.wasSuccessful())
