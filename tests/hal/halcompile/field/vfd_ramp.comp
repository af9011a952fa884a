component vfd_ramp """Ramp for a VFD
with several lines of text.

.B speed
is bounded.""";
description """
This component ramps a speed command.
.P
It has two paragraphs and a backslash-dash \\- here.
""";
see_also "\\fBlimit2\\fR(9), limit3(9)";
examples "loadrt vfd_ramp count=2";
notes "Mind the units: 1/min";
author "J. Doe <jd at example.com>";
license "GPLv2 or later";
pin in float cmd "command [1/min]";
pin in bit forward = 1 "direction";
pin out float out_rpm = 0.0;
pin io bit trip;
param rw float max_accel = 100.5 "1/min/s";
param r float peak;
variable double last = 0.0;
variable int state[4];
function _ fp "update";
;;
#include <rtapi_math.h>
FUNCTION(_) {
  double d = cmd - last, m = max_accel * fperiod;
  if (!forward) d = -cmd - last;
  if (d > m) d = m;
  if (d < -m) d = -m;
  last += d;
  out_rpm = last;
  if (fabs(last) > peak) peak = fabs(last);
  state[0]++;
  if (trip) { trip = 0; last = 0; }
}
