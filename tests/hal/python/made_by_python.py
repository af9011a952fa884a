"""hal.stream and hal.shm between two Python components, and what else a component asks of the host."""
import errno
import unittest

import hal


class Python(unittest.TestCase):
    def setUp(self):
        self.maker, self.user = hal.component("maker"), hal.component("user")

    def tearDown(self):
        self.maker.exit()
        self.user.exit()

    def test_writer_and_reader(self):
        writer = hal.stream(self.maker, 77, 4, "bfsu")
        self.assertEqual(repr(writer), "<stream 0x4d creator>")
        self.assertEqual((writer.depth, writer.maxdepth, writer.element_types), (0, 4, b"bfsu"))
        self.assertEqual((writer.num_overruns, writer.num_underruns, writer.sampleno), (0, 0, 0))
        self.assertIs(writer.readable, False)
        self.assertIs(writer.writable, True)
        reader = hal.stream(self.user, 77, "BFSU")
        self.assertEqual(repr(reader), "<stream 0x4d>")
        self.assertIsNone(reader.read())
        self.assertEqual(writer.num_underruns, 1)
        for wrong, error in (((1, 2.5, -3), ValueError), ((1, 2.5, -3, 4, 5), ValueError), ((1, 2.5, 2**31, 4), OverflowError),
                             ((1, "x", 1, 4), TypeError), ((1, 2.5, 1, -1), OverflowError), ([1, 2, 3, 4], TypeError),
                             (3, TypeError)):
            with self.subTest(wrong=wrong), self.assertRaises(error):
                writer.write(wrong)
        for i in range(4):
            writer.write((i, i / 2, -i, i))
        for _ in range(2):
            with self.assertRaises(OSError) as caught:
                writer.write((1, 2, 3, 4))
            self.assertEqual(caught.exception.errno, errno.ENOSPC)
        self.assertEqual((reader.depth, reader.num_overruns), (4, 2))
        self.assertEqual(reader.read(), (False, 0.0, 0, 0))
        self.assertEqual(reader.sampleno, 1)
        writer.write((1, 9, 9, 9))
        self.assertEqual([reader.read() for _ in range(4)],
                         [(True, 0.5, -1, 1), (True, 1.0, -2, 2), (True, 1.5, -3, 3), (True, 9.0, 9, 9)])
        self.assertEqual(reader.sampleno, 7)  # the two that found no room have numbers too
        with self.assertRaises(AttributeError):
            writer.depth = 3

    def test_one_maker_a_key_and_its_end(self):
        hal.set_msg_level(hal.MSG_NONE)
        first = hal.stream(self.maker, 78, 4, "f")
        with self.assertRaises(OSError) as caught:
            hal.stream(self.user, 78, 4, "f")
        self.assertEqual(caught.exception.errno, errno.EEXIST)
        del first
        with self.assertRaises(OSError):
            hal.stream(self.user, 78)
        again = hal.stream(self.user, 78, 6, "bb")
        self.assertEqual(again.maxdepth, 6)
        hal.set_msg_level(hal.MSG_ERR)

    def test_of_a_closed_component(self):
        other = hal.component("other")
        stream = hal.stream(other, 79, 4, "f")
        other.exit()
        with self.assertRaises(RuntimeError):
            stream.read()

    def test_shared_memory(self):
        memory = hal.shm(self.maker, 1234, 100)
        self.assertEqual(repr(memory)[:34], "<shared memory buffer key=000004d2")
        view = memory.getbuffer()
        self.assertEqual((len(view), view.readonly), (100, False))
        view[:5] = b"hello"
        self.assertEqual(bytes(hal.shm(self.user, 1234, 50).getbuffer()[:6]), b"hello\0")
        with self.assertRaises(OSError):
            hal.shm(self.user, 1234, 101)  # more than there is
        memory.setsize(5)
        self.assertEqual(bytes(memory.getbuffer()), b"hello")


class Again(unittest.TestCase):
    def test_pins_after_unready(self):
        c = hal.component("again")
        c.ready()
        c.unready()
        self.assertFalse(hal.component_is_ready("again"))
        c.newpin("late", hal.HAL_BIT, hal.HAL_IN)
        c.ready()
        self.assertTrue(hal.component_is_ready("again"))


unittest.main(verbosity=1)
