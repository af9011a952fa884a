"""hal.stream at one end, halstreamer or halsampler at the other."""
import subprocess
import unittest

import hal


class Programs(unittest.TestCase):
    def setUp(self):
        self.c = hal.component("ends")
        self.c.ready()

    def tearDown(self):
        self.c.exit()

    def test_rows_of_halstreamer(self):
        end = hal.stream(self.c, hal.streamer_base, 8, "fsbk")
        rows = [(0.5, -3, True, 7), (-1e9, 2**31 - 1, False, 2**64 - 1), (0.0, 0, True, 0)] * 10
        text = "".join(f"{f!r} {s} {int(b)} {k}\n" for f, s, b, k in rows)
        with subprocess.Popen(["halstreamer", "-N", "player"], stdin=subprocess.PIPE, text=True) as program:
            program.stdin.write("# more rows than the stream holds\n" + text)
            program.stdin.close()
            got = []
            while len(got) < len(rows):
                row = end.read()
                if row is None:
                    self.assertTrue(program.poll() is None or end.readable, "the program ended too early")
                else:
                    got.append(row)
            self.assertEqual(program.wait(30), 0)
        self.assertEqual(got, rows)
        self.assertEqual(end.num_overruns, 0)

    def test_rows_for_halsampler(self):
        end = hal.stream(self.c, hal.sampler_base + 2, 16, "ufb")
        for i in range(5):
            end.write((i * 1000, i / 4, i % 2 == 0))
        said = subprocess.run(["halsampler", "-c", "2", "-n", "5", "-t"], stdout=subprocess.PIPE, text=True, timeout=30,
                              check=True).stdout
        self.assertEqual([line.split() for line in said.splitlines()],
                         [[str(i), str(i * 1000), f"{i / 4:f}", str(int(i % 2 == 0))] for i in range(5)])

    def test_a_line_that_is_no_row_is_named_and_left_out(self):
        end = hal.stream(self.c, hal.streamer_base + 1, 4, "ff")
        run = subprocess.run(["halstreamer", "-c", "1"], input="1 2\nno number\n3 4\n", text=True, timeout=30,
                             stderr=subprocess.PIPE, check=False)
        self.assertIn("line 1, field 0: ", run.stderr)
        self.assertEqual([end.read(), end.read(), end.read()], [(1.0, 2.0), (3.0, 4.0), None])


if __name__ == "__main__":
    unittest.main()
