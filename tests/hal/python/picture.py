#!/usr/bin/python3
"""Writes two lines of a picture to its port as soon as there is one."""
import time

import hal

LINES = b"1;4;2;6;0F4CF2%\n" + b"-0.5;8;-4;6;FF0080BF40FF%\n"

h = hal.component("picture")
out = h.newpin("out", hal.HAL_PORT, hal.HAL_OUT)
h.ready()
try:
    while not out.write(LINES):
        time.sleep(0.001)
    while True:
        time.sleep(1)
except KeyboardInterrupt:
    raise SystemExit
