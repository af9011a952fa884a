"""Parts of which a canon for gcode.parse() is made.

    class Canon(Translated, ArcsToSegmentsMixin, StatMixin):
        def __init__(self, stat):
            StatMixin.__init__(self, stat, False)
            self.lo = (0,) * 9
        def straight_traverse_translated(self, *point): ...
        def straight_feed_translated(self, *point): ...
        def straight_arcsegments(self, points): ...

Points are in machine coordinates and inches there.
"""
import math

import gcode

#: A row of the tool table for an empty spindle.
empty_spindle_data = (-1,) + (0.0,) * 12 + (0,)
#: Where get_tool() has the spindle.
tool_in_spindle = 0

_AXES = "xyzabcuvw"


class Translated:
    """Adds offsets and rotation: straight_traverse and straight_feed become calls of ..._translated in machine coordinates."""
    rotation_xy = 0
    rotation_cos = 1.0
    rotation_sin = 0.0
    for _axis in _AXES:
        locals()["g5x_offset_" + _axis] = locals()["g92_offset_" + _axis] = 0.0
    del _axis

    def rotate_and_translate(self, x, y, z, a, b, c, u, v, w):
        x, y = x + self.g92_offset_x, y + self.g92_offset_y
        x, y = x * self.rotation_cos - y * self.rotation_sin, x * self.rotation_sin + y * self.rotation_cos
        return (x + self.g5x_offset_x, y + self.g5x_offset_y,
                z + self.g92_offset_z + self.g5x_offset_z, a + self.g92_offset_a + self.g5x_offset_a,
                b + self.g92_offset_b + self.g5x_offset_b, c + self.g92_offset_c + self.g5x_offset_c,
                u + self.g92_offset_u + self.g5x_offset_u, v + self.g92_offset_v + self.g5x_offset_v,
                w + self.g92_offset_w + self.g5x_offset_w)

    def straight_traverse(self, *args):
        self.straight_traverse_translated(*self.rotate_and_translate(*args))

    def straight_feed(self, *args):
        self.straight_feed_translated(*self.rotate_and_translate(*args))

    def set_g5x_offset(self, index, x, y, z, a, b, c, u=None, v=None, w=None):
        self._set_offsets("g5x_offset_", (x, y, z, a, b, c, u, v, w))

    def set_g92_offset(self, x, y, z, a, b, c, u=None, v=None, w=None):
        self._set_offsets("g92_offset_", (x, y, z, a, b, c, u, v, w))

    def _set_offsets(self, prefix, values):
        for axis, value in zip(_AXES, values):
            if value is not None:
                setattr(self, prefix + axis, value)

    def set_xy_rotation(self, theta):
        self.rotation_xy = theta
        self.rotation_cos = math.cos(math.radians(theta))
        self.rotation_sin = math.sin(math.radians(theta))


class ArcsToSegmentsMixin:
    """Makes arcs calls of straight_arcsegments(points). Needs `lo`, the last point in machine coordinates."""
    plane = 1
    #: Pieces of a whole turn.
    arcdivision = 64

    def set_plane(self, plane):
        self.plane = plane

    def arc_feed(self, x1, y1, cx, cy, rot, z1, a, b, c, u, v, w):
        self.lo = tuple(self.lo)
        self.straight_arcsegments(gcode.arc_to_segments(self, x1, y1, cx, cy, rot, z1, a, b, c, u, v, w,
                                                        self.arcdivision))


class PrintCanon:
    """Prints its calls."""

    def set_g5x_offset(self, *args):
        print("set_g5x_offset", args)

    def set_g92_offset(self, *args):
        print("set_g92_offset", args)

    def next_line(self, state):
        print("next_line", state.sequence_number)
        self.state = state

    def set_plane(self, plane):
        print("set plane", plane)

    def set_feed_rate(self, arg):
        print("set feed rate", arg)

    def comment(self, arg):
        print("#", arg)

    def straight_traverse(self, *args):
        print("straight_traverse %.4g %.4g %.4g  %.4g %.4g %.4g" % args[:6])

    def straight_feed(self, *args):
        print("straight_feed %.4g %.4g %.4g  %.4g %.4g %.4g" % args[:6])

    def dwell(self, arg):
        if arg < 0.1:
            print("dwell %f ms" % (1000 * arg))
        else:
            print("dwell %f seconds" % arg)

    def arc_feed(self, *args):
        print("arc_feed %.4g %.4g  %.4g %.4g %.4g  %.4g  %.4g %.4g %.4g" % args[:9])


class StatMixin:
    """Answers questions of the interpreter from a linuxcnc.stat. `r`: whether the machine has a random tool changer."""

    def __init__(self, s, r):
        self.s = s
        self.random = r
        self.tools = list(s.tool_table) or [empty_spindle_data]

    def change_tool(self, idx):
        if self.random and 0 <= idx < len(self.tools):
            self.tools[0], self.tools[idx] = self.tools[idx], self.tools[0]
        elif idx <= 0 or idx >= len(self.tools):
            self.tools[0] = empty_spindle_data
        else:
            self.tools[0] = self.tools[idx]

    def get_tool(self, idx):
        if 0 <= idx < len(self.tools):
            return tuple(self.tools[idx])
        return empty_spindle_data

    def get_external_angular_units(self):
        return self.s.angular_units or 1.0

    def get_external_length_units(self):
        return self.s.linear_units or 1.0

    def get_axis_mask(self):
        return self.s.axis_mask

    def get_block_delete(self):
        return self.s.block_delete
