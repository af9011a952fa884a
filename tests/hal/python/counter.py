"""Adds up its input every 5 ms."""
import time

import hal

c = hal.component("counter")
c.newpin("in", hal.HAL_FLOAT, hal.HAL_IN)
c.newpin("out", hal.HAL_FLOAT, hal.HAL_OUT)
c.ready()
try:
    while True:
        c["out"] += c["in"]
        time.sleep(0.005)
except KeyboardInterrupt:
    pass
