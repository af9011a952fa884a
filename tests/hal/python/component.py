"""Pins, parameters, signals, queries and their errors, as the newest LinuxCNC has them (captured)."""
import math
import os
import subprocess
import sys
import threading
import time
import unittest

import hal
from hal import query

TYPES = {"b": hal.HAL_BIT, "f": hal.HAL_FLOAT, "s": hal.HAL_S32, "u": hal.HAL_U32, "l": hal.HAL_S64, "k": hal.HAL_U64}


def outcome(call, *args):
    """The value, or "TYPE: text" of the exception."""
    try:
        return call(*args)
    except Exception as error:  # pylint: disable=broad-except
        kind = type(error)
        name = kind.__name__ if kind.__module__ == "builtins" else f"{kind.__module__}.{kind.__name__}"
        return f"{name}: {error}"


class EveryType(unittest.TestCase):
    def setUp(self):
        self.c = hal.component("types")
        for letter, kind in TYPES.items():
            for name, direction in (("in", hal.HAL_IN), ("out", hal.HAL_OUT), ("io", hal.HAL_IO)):
                self.c.newpin(f"{letter}-{name}", kind, direction)
            for name, direction in (("ro", hal.HAL_RO), ("rw", hal.HAL_RW)):
                self.c.newparam(f"{letter}-{name}", kind, direction)
        self.c.ready()

    def tearDown(self):
        self.c.exit()

    def set(self, name, value):
        """What the item has after an assignment, or the exception."""
        return outcome(lambda: (self.c.__setitem__(name, value), self.c[name])[1])

    def test_values(self):
        for name, given, expected in (
                ("b-out", True, True), ("b-out", 2, True), ("b-out", None, False), ("b-out", "x", True), ("b-out", [], False),
                ("f-out", 3, 3.0), ("f-out", "1.5", 1.5), ("f-out", True, 1.0),
                ("f-out", None, "TypeError: Number expected, not NoneType"),
                ("f-out", "x", "TypeError: Number expected, not str"),
                ("f-out", 10**400, "OverflowError: int too large to convert to float"),
                ("s-out", 5, 5), ("s-out", -2**31, -2**31), ("s-out", 1.9, 1), ("s-out", -1.9, -1), ("s-out", "3", 3),
                ("s-out", 2**31, "OverflowError: Value 2147483648 out of range"),
                ("s-out", -2**31 - 1, "OverflowError: Value -2147483649 out of range"),
                ("s-out", 2**70, "OverflowError: int too big to convert"),
                ("s-out", math.nan, "ValueError: cannot convert float NaN to integer"),
                ("s-out", math.inf, "OverflowError: cannot convert float infinity to integer"),
                ("s-out", None, "TypeError: int() argument must be a string, a bytes-like object or a real number, not "
                                "'NoneType'"),
                ("u-out", 2**32 - 1, 2**32 - 1), ("u-out", 1.9, 1), ("u-out", True, 1),
                ("u-out", 2**32, "OverflowError: Value 4294967296 out of range"),
                ("u-out", -1, "OverflowError: Value -1 out of range"),
                ("u-out", 2**64, "OverflowError: int too big to convert"),
                ("u-out", "x", "ValueError: invalid literal for int() with base 10: 'x'"),
                ("l-out", 2**63 - 1, 2**63 - 1), ("l-out", -2**63, -2**63), ("l-out", 1.5, 1),
                ("l-out", 2**63, "OverflowError: int too big to convert"),
                ("k-out", 2**64 - 1, 2**64 - 1), ("k-out", -1, "OverflowError: Value -1 out of range"),
                ("k-out", 2**64, "OverflowError: int too big to convert")):
            with self.subTest(name=name, given=given):
                got = self.set(name, given)
                self.assertEqual(got, expected)
                self.assertIs(type(got), type(expected))
        self.c["f-out"] = math.nan
        self.assertTrue(math.isnan(self.c["f-out"]))

    def test_every_direction_can_be_written_by_its_owner(self):
        for letter in TYPES:
            for name in ("in", "out", "io", "ro", "rw"):
                self.assertEqual(self.set(f"{letter}-{name}", 1), 1)
                self.assertEqual(hal.get_value(f"types.{letter}-{name}"), 1)

    def test_others_see_the_values(self):
        self.c["l-out"] = -2**40
        self.c["s-rw"] = -5
        self.assertEqual(query.pin("types.l-out")["value"], -2**40)
        self.assertTrue(hal.set_p("types.s-rw", -6))
        self.assertEqual(self.c["s-rw"], -6)
        self.assertTrue(hal.set_p("types.k-rw", str(2**64 - 1)))
        self.assertEqual(self.c["k-rw"], 2**64 - 1)
        self.assertTrue(hal.set_p("types.f-in", 0.1))
        self.assertEqual(self.c["f-in"], 0.1)

    def test_items(self):
        self.assertEqual(str(self.c.getitem("b-in")), '<hal pin "b-in" BIT-IN>')
        self.assertEqual(repr(self.c.getitem("f-rw")), '<hal param "f-rw" FLOAT-RW>')
        self.assertEqual(repr(self.c.getitem("l-io")), '<hal pin "l-io" S64-IO>')
        pin, param = self.c.getpin("f-out"), self.c.getparam("f-rw")
        self.assertIsInstance(pin, hal.Pin)
        self.assertIsInstance(param, hal.Param)
        pin.set(4.5)
        self.assertEqual((pin.get(), pin.get_name(), pin.get_type(), pin.get_dir(), pin.is_pin()),
                         (4.5, "f-out", hal.HAL_FLOAT, hal.HAL_OUT, True))
        self.assertEqual((pin.name, pin.type, pin.dir, pin.value), ("f-out", 2, 32, 4.5))
        pin.value = 7
        self.assertEqual(self.c["f-out"], 7.0)
        self.assertEqual((param.is_pin(), param.dir), (False, hal.HAL_RW))
        self.assertEqual(outcome(pin.set, "x"), "TypeError: Number expected, not str")
        with self.assertRaises(AttributeError):
            pin.name = "x"
        with self.assertRaises(TypeError):
            hal.Pin("x")
        with self.assertRaises(TypeError):
            hal.item()
        self.assertEqual(len(self.c), 30)
        self.assertEqual(len(self.c.getpins()), 30)
        self.assertEqual(self.c.getitems(), self.c.getpins())

    def test_many_threads_at_once(self):
        def work(letter, errors):
            try:
                for i in range(200):
                    self.c[f"{letter}-out"] = i % 2
                    hal.set_p(f"types.{letter}-rw", i % 2)
                    if hal.get_value(f"types.{letter}-rw") != i % 2:
                        errors.append(letter)
            except Exception as error:  # pylint: disable=broad-except
                errors.append(error)
        errors = []
        threads = [threading.Thread(target=work, args=(letter, errors)) for letter in TYPES]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(errors, [])


class Transcript(unittest.TestCase):
    """What the newest LinuxCNC answers to the same calls."""

    def setUp(self):
        self.c = hal.component("qc")
        self.c.newpin("in", hal.HAL_FLOAT, hal.HAL_IN)
        self.c.newpin("out", hal.HAL_S64, hal.HAL_OUT)
        self.port = self.c.newpin("port", hal.HAL_PORT, hal.HAL_IN)
        self.c.newparam("par", hal.HAL_U32, hal.HAL_RW)
        self.c.ready()
        hal.set_msg_level(hal.MSG_NONE)

    def tearDown(self):
        self.c.exit()
        hal.set_msg_level(hal.MSG_ERR)
        for name in query.signals():
            os.system(f"halcmd delsig {name}")

    def test_signals(self):
        self.assertIs(hal.new_sig("level", hal.HAL_FLOAT), False)  # False: it worked
        self.assertIs(hal.connect("qc.in", "level"), False)
        self.assertIs(hal.connect("qc.in", "level"), False)
        self.assertIs(hal.new_sig("level", hal.HAL_FLOAT), True)
        self.assertIs(hal.connect("qc.in", "nosuch"), True)
        self.assertIs(hal.connect("qc.nope", "level"), True)
        self.assertIs(hal.connect("qc.out", "level"), True)
        self.assertIs(hal.set_s("level", "2.5"), True)
        self.assertIs(hal.set_s("level", 3.25), True)
        self.assertEqual(hal.get_s("level"), 3.25)
        self.assertIsNone(hal.get_s("nosuch"))
        self.assertEqual(hal.get_value("qc.in"), 3.25)
        self.assertEqual(hal.get_value("level"), 3.25)
        self.assertEqual(outcome(hal.get_value, "nosuch"), "RuntimeError: get_value: nosuch: not found")
        self.assertEqual(outcome(hal.set_s, "nosuch", 1), "RuntimeError: set_s: nosuch: not found")
        self.assertIs(hal.disconnect("qc.in"), False)
        self.assertIs(hal.disconnect("qc.in"), False)
        self.assertIs(hal.disconnect("nope"), True)
        self.assertEqual(outcome(hal.new_sig, "x", 99), "RuntimeError: not a valid HAL signal type")

    def test_parameters(self):
        hal.new_sig("level", hal.HAL_FLOAT)
        hal.connect("qc.in", "level")
        self.assertIs(hal.set_p("qc.par", "7"), True)
        self.assertEqual(hal.get_p("qc.par"), 7)
        self.assertIsNone(hal.get_p("qc.nope"))
        self.assertEqual(outcome(hal.set_p, "qc.nope", "7"), "RuntimeError: set_p: qc.nope: not found")
        self.assertEqual(outcome(hal.set_p, "qc.par", "x"), "RuntimeError: set_p: qc.par: invalid argument")
        self.assertEqual(outcome(hal.set_p, "qc.in", "1"), "RuntimeError: set_p: qc.in: not writable")
        self.assertEqual(outcome(hal.set_p, "qc.out", "1"), "RuntimeError: set_p: qc.out: not writable")

    def test_component(self):
        c = self.c
        c["out"] = 5
        self.assertEqual(c["out"], 5)
        c.out = 1.5
        self.assertEqual(c.out, 1)
        c["in"] = 1.0
        self.assertEqual(outcome(lambda: c["nope"]), "AttributeError: Pin or param 'nope' does not exist")
        self.assertEqual(outcome(lambda: c.nope), "AttributeError: Pin or param 'nope' does not exist")
        self.assertEqual(outcome(setattr, c, "nope", 1), "AttributeError: Pin or param 'nope' does not exist")
        self.assertEqual(outcome(c.getpin, "par"), "AttributeError: Pin 'par' does not exist")
        self.assertEqual(outcome(c.newpin, "x", hal.HAL_BIT, hal.HAL_IN), "hal.error: Invalid argument")
        self.assertEqual(outcome(c.newpin, "out", hal.HAL_BIT, hal.HAL_IN), "ValueError: Duplicate pin name 'out'")
        self.assertEqual(outcome(c.newparam, "out", hal.HAL_BIT, hal.HAL_RW), "ValueError: Duplicate parameter name 'out'")
        self.assertEqual(outcome(c.newpin, "x" * 60, hal.HAL_BIT, hal.HAL_IN),
                         f'hal.error: Invalid pin name length "qc.{"x" * 60}": max = 55 characters')
        self.assertEqual(outcome(c.newpin, "bad", 99, hal.HAL_IN), "hal.error: Invalid pin type 99")
        self.assertEqual(outcome(c.newparam, "bad", 99, hal.HAL_RW), "hal.error: Invalid param type 99")
        self.assertEqual(outcome(c.newpin, "bad", hal.HAL_BIT, hal.HAL_RW), "hal.error: Invalid argument")
        self.assertEqual(outcome(hal.component, "qc"), "hal.error: File exists")
        self.assertEqual(outcome(hal.component, "x" * 60), "hal.error: Invalid argument")
        self.assertEqual(outcome(c.ready), "hal.error: Invalid argument")
        self.assertRegex(repr(c), r"<hal component qc\(\d+\) with 4 pins and params>")
        self.assertEqual(c.getprefix(), "qc")

    def test_port(self):
        hal.new_sig("prt", hal.HAL_PORT)
        hal.connect("qc.port", "prt")
        self.assertIs(hal.set_s("prt", 64), True)
        self.assertEqual(self.port.size(), 64)
        self.c["in"] = 1.0
        self.c["out"] = 1
        self.c["par"] = 7
        self.assertEqual(self.c.getpins(), {"in": 1.0, "out": 1, "par": 7, "port": 64})
        other = hal.component("writer")
        port = other.newpin("port", hal.HAL_PORT, hal.HAL_OUT)
        self.assertIs(port.write(b"nothing is linked"), False)
        hal.connect("writer.port", "prt")
        self.assertIs(port.write(b"hello"), True)
        self.assertIs(port.write(b"x" * 60), False)
        self.assertEqual((port.writable(), self.port.readable()), (59, 5))
        self.assertIsNone(self.port.read(6))
        self.assertEqual(self.port.peek(4), b"hell")
        self.assertIs(self.port.peek_commit(1), True)
        self.assertEqual(self.port.read(4), b"ello")
        port.write(bytearray(range(64)))
        self.assertEqual(self.port.read(64), bytes(range(64)))
        port.write(b"abc")
        self.port.clear()
        self.assertEqual(self.port.readable(), 0)
        self.assertRaises(TypeError, self.c.getitem("in").read, 1)
        other.exit()

    def test_query(self):
        hal.new_sig("level", hal.HAL_FLOAT)
        hal.connect("qc.in", "level")
        self.c["in"] = 1.0
        self.c["par"] = 7
        number = query.comp("qc")["id"]
        pin = {"haltype": "pin", "name": "qc.in", "type": hal.Type.REAL, "dir": hal.Dir.IN, "value": 1.0, "alias": None,
               "signal": "level", "comp": "qc", "comp_id": number}
        self.assertEqual(query.pin("qc.in"), pin)
        self.assertEqual(list(query.pin("qc.in")), list(pin))
        self.assertEqual(repr(query.pin("qc.in")["type"]), "<Type.REAL: 2>")
        self.assertIsNone(query.pin("nope"))
        self.assertEqual(query.param("qc.par"),
                         {"haltype": "parameter", "name": "qc.par", "type": hal.Type.U32, "dir": hal.Dir.RW, "value": 7,
                          "alias": None, "comp": "qc", "comp_id": number})
        self.assertEqual(query.signal("level"),
                         {"haltype": "signal", "name": "level", "type": hal.Type.REAL, "value": 1.0, "writers": 0, "readers": 1,
                          "bidirs": 0, "driver": None})
        self.assertEqual(query.signalpins("level"), {"qc.in": pin})
        self.assertIsNone(query.signalpins("nope"))
        and2 = query.comp("and2")
        self.assertEqual(and2, {"haltype": "component", "name": "and2", "type": hal.CompType.REALTIME, "id": and2["id"],
                                "pid": 0, "ready": True, "insmod": ""})
        self.assertEqual(query.comp(and2["id"]), and2)
        self.assertEqual(query.comp("qc")["pid"], os.getpid())
        self.assertIsNone(query.comp("qc")["insmod"])
        self.assertEqual(query.funct("and2.0"),
                         {"haltype": "function", "name": "and2.0", "comp": "and2", "comp_id": and2["id"], "users": 1,
                          "reentrant": False})
        thread = query.thread("t")
        self.assertEqual((thread["comp"], thread["priority"], thread["period"]), ("__t", 0, 1000000))
        self.assertEqual(thread["functions"],
                         [{"haltype": "threadfunction", "name": "and2.0", "index": 0, "is_init": False}])
        for plural, one in ((query.pins, "and2.0.in0"), (query.params, "and2.0.tmax"), (query.signals, "level"),
                            (query.comps, "and2"), (query.functs, "and2.0"), (query.threads, "t")):
            self.assertIn(one, plural())

    def test_info(self):
        self.assertEqual(hal.get_info_pins()[0], {"NAME": "and2.0.in0", "VALUE": False, "DIRECTION": 16, "TYPE": 1})
        hal.new_sig("level", hal.HAL_BIT)
        hal.connect("and2.0.out", "level")
        self.assertEqual(hal.get_info_signals(), [{"NAME": "level", "VALUE": False, "DRIVER": "and2.0.out", "TYPE": 1}])
        self.assertIn({"NAME": "qc.par", "VALUE": 0, "DIRECTION": 192, "TYPE": 4}, hal.get_info_params())
        self.assertTrue(hal.pin_has_writer("and2.0.out"))
        self.assertFalse(hal.pin_has_writer("qc.in"))
        self.assertEqual(outcome(hal.pin_has_writer, "nope"), "NameError: Pin `nope' does not exist")


class Life(unittest.TestCase):
    def test_several_components_with_prefixes(self):
        a, b = hal.component("a"), hal.component("b", "other")
        a.setprefix("third")
        self.assertEqual((a.getprefix(), b.getprefix()), ("third", "other"))
        a.newpin("x", hal.HAL_BIT, hal.HAL_IN)
        b.newpin("x", hal.HAL_BIT, hal.HAL_IN)
        self.assertTrue(hal.component_exists("a"))
        self.assertFalse(hal.component_is_ready("a"))
        a.ready()
        self.assertTrue(hal.component_is_ready("a"))
        self.assertTrue({"third.x", "other.x"} <= set(query.pins()))
        a.exit()
        self.assertFalse(hal.component_exists("a"))
        self.assertEqual(outcome(len, a), "RuntimeError: Invalid operation on closed HAL component")
        del b
        self.assertFalse(hal.component_exists("b"))
        self.assertNotIn("other.x", query.pins())

    def test_items_of_a_closed_component_raise(self):
        c = hal.component("short")
        pin = c.newpin("x", hal.HAL_BIT, hal.HAL_OUT)
        del c
        self.assertEqual(outcome(pin.get), "RuntimeError: Invalid operation on closed HAL component")
        self.assertEqual(outcome(pin.set, 1), "RuntimeError: Invalid operation on closed HAL component")

    def test_a_forked_child_cannot_use_its_parents_components(self):
        c = hal.component("parent")
        pin = c.newpin("x", hal.HAL_BIT, hal.HAL_OUT)
        child = os.fork()
        if child == 0:
            code = 0
            for call in (pin.get, lambda: c["x"], c.ready):
                if not outcome(call).startswith("hal.error: component 'parent' belongs to the process"):
                    code = 1
            own = hal.component("child")
            own.newpin("y", hal.HAL_BIT, hal.HAL_OUT)
            own["y"] = True
            code += 0 if hal.get_value("child.y") and hal.component_exists("parent") else 2
            del c
            os._exit(code)
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 0)
        c["x"] = True
        c.ready()
        self.assertTrue(hal.component_is_ready("parent"))
        self.assertIs(c["x"], True)

    def test_a_dead_process_leaves_nothing(self):
        program = "import hal, sys, time\nc = hal.component('mortal')\nc.newpin('x', hal.HAL_BIT, hal.HAL_OUT)\nc.ready()\n" \
                  "print('there', flush=True)\nsys.stdin.readline()\n"
        for end in ("exit", "kill"):
            with self.subTest(end=end), subprocess.Popen([sys.executable, "-c", program], stdin=subprocess.PIPE,
                                                         stdout=subprocess.PIPE) as child:
                self.assertEqual(child.stdout.readline(), b"there\n")
                self.assertTrue(hal.component_is_ready("mortal"))
                if end == "kill":
                    child.kill()
                else:
                    child.stdin.write(b"\n")
                    child.stdin.flush()
                self.assertEqual(child.wait(), -9 if end == "kill" else 0)
                while end == "kill" and hal.component_exists("mortal"):
                    time.sleep(0.001)  # the host sees it when it looks next
                self.assertFalse(hal.component_exists("mortal"))

    def test_constants(self):
        self.assertEqual((hal.HAL_BIT, hal.HAL_FLOAT, hal.HAL_S32, hal.HAL_U32, hal.HAL_PORT, hal.HAL_S64, hal.HAL_U64),
                         (1, 2, 3, 4, 5, 6, 7))
        self.assertEqual((hal.HAL_IN, hal.HAL_OUT, hal.HAL_IO, hal.HAL_RO, hal.HAL_RW), (16, 32, 48, 64, 192))
        self.assertEqual((hal.MSG_NONE, hal.MSG_ERR, hal.MSG_WARN, hal.MSG_INFO, hal.MSG_DBG, hal.MSG_ALL), tuple(range(6)))
        self.assertEqual((hal.sampler_base, hal.streamer_base), (1213415728, 1213420592))
        self.assertEqual((hal.is_kernelspace, hal.is_userspace, hal.kernel_version), (0, 1, "Not Available"))
        self.assertEqual((hal.REALTIME_TYPE_NONE, hal.REALTIME_TYPE_PREEMPT_RT), (0, 3))
        self.assertIs(type(hal.HAL_BIT), int)
        self.assertIs(hal.Type.HAL_REAL, hal.Type.REAL)
        self.assertFalse(hasattr(hal.Type, "BIT"))
        with self.assertWarns(FutureWarning):
            self.assertIn(hal.is_sim, (0, 1))
        self.assertEqual(hal.get_msg_level(), hal.MSG_ERR)
        c = hal.component("some")
        self.assertIs(hal.is_initialized(), True)
        del c


unittest.main(verbosity=1)
