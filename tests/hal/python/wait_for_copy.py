"""Ends when passthrough has copied."""
import time

import hal

while hal.get_value("passthrough.out") != 3.25:
    time.sleep(0.001)
