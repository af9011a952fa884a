"""hal.stream: realtime to Python and back."""
import errno
import os
import random
import time
import unittest

import hal


class Realtime(unittest.TestCase):
    def setUp(self):
        self.c = hal.component("rows")

    def tearDown(self):
        self.c.exit()

    def test_rows_go_through_pins_and_come_back_exactly(self):
        out = hal.stream(self.c, hal.streamer_base, "bfsulk")
        back = hal.stream(self.c, hal.sampler_base, "BFSULK")
        self.assertEqual(out.element_types, b"bfsulk")
        self.assertEqual((out.maxdepth, out.depth), (100, 0))
        rng = random.Random(7)
        rows = [(bool(rng.getrandbits(1)), rng.uniform(-1e6, 1e6), rng.randint(-2**31, 2**31 - 1), rng.getrandbits(32),
                 rng.randint(-2**63, 2**63 - 1), rng.getrandbits(64)) for _ in range(50)]
        rows += [(True, 1e-300, 2**31 - 1, 2**32 - 1, 2**63 - 1, 2**64 - 1), (False, -0.0, -2**31, 0, -2**63, 0)]
        for row in rows:
            out.write(row)
        self.assertEqual(out.depth, len(rows))
        hal.set_p("sampler.0.enable", 1)
        os.system("halcmd start")
        got = []
        while len(got) < len(rows):
            row = back.read()
            if row is None:
                time.sleep(0.001)
            else:
                got.append(row)
                self.assertEqual(back.sampleno, len(got))
        os.system("halcmd stop")
        self.assertEqual(got, rows)
        self.assertEqual(str(got[-1][1]), "-0.0")

    def test_errors(self):
        hal.set_msg_level(hal.MSG_NONE)
        for args in ((4711,), (4711, "b"), (hal.sampler_base, "b"), (hal.sampler_base, "bfsulf"), (4711, 0, "b"),
                     (4711, 10, "x"), (4711, 10, ""), (4711, 10, "b" * 22), (4711, -1, "b")):
            with self.subTest(args=args), self.assertRaises(OSError) as caught:
                hal.stream(self.c, *args)
            self.assertEqual(caught.exception.errno, errno.EINVAL)
        hal.set_msg_level(hal.MSG_ERR)
        with self.assertRaises(TypeError):
            hal.stream("x", 1, "b")
        with self.assertRaises(TypeError):
            hal.stream(self.c)


unittest.main(verbosity=1)
