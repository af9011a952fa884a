#!/usr/bin/python3
"""Copies its input to its output."""
import time

import hal

h = hal.component("passthrough")
h.newpin("in", hal.HAL_FLOAT, hal.HAL_IN)
h.newpin("out", hal.HAL_FLOAT, hal.HAL_OUT)
h.ready()
try:
    while True:
        h["out"] = h["in"]
        time.sleep(0.001)
except KeyboardInterrupt:
    raise SystemExit
