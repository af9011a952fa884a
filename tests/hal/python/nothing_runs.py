"""Without a running HAL the module loads, and says how to start one."""
import os
import unittest

os.environ["KERF_INSTANCE"] = f"test-none-{os.getpid()}"
import hal  # noqa: E402
from hal import query  # noqa: E402


class Nothing(unittest.TestCase):
    def test_calls_say_how_to_start(self):
        for call, error in ((lambda: hal.component("x"), hal.error), (lambda: hal.component_exists("x"), RuntimeError),
                            (query.pins, RuntimeError), (lambda: hal.new_sig("s", 1), RuntimeError)):
            with self.assertRaises(error) as caught:
                call()
            self.assertIn("halrun", str(caught.exception))
            self.assertIn(os.environ["KERF_INSTANCE"], str(caught.exception))
        self.assertIs(hal.is_initialized(), False)
        self.assertEqual(hal.get_realtime_type(), hal.RTType.UNINITIALIZED)


unittest.main(verbosity=1)
