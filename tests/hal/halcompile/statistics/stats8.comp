component stats8 "Mean and spread of the last values, any number up to 32";
pin in float in;
pin in bit reset_;
pin out float mean;
pin out float spread;
pin out s32 n;
variable double window_[32];
variable unsigned at = 0;
function _ "Takes one value";
include <rtapi_math.h>;
license "GPL";
;;
FUNCTION(_) {
    double s = 0, q = 0;
    int i;
    if (reset_) { at = 0; n = 0; return; }
    window_[at++ % 32] = in;
    if (n < 32) n = n + 1;
    for (i = 0; i < n; i++) { s += window_[i]; q += window_[i] * window_[i]; }
    mean = s / n;
    spread = sqrt(fmax(q / n - mean * mean, 0));
}
