component with_data;
pin in s32 in;
pin out s32 most;
pin out s32 calls;
option data ring_t;
include <rtapi_math.h>;
function _;
license "GPL";
;;
typedef struct { int value[4]; int at; } ring_t;
FUNCTION(_) {
    int i;
    data.value[data.at] = in;
    data.at = (data.at + 1) % 4;
    most = data.value[0];
    for (i = 1; i < 4; i++) if (data.value[i] > most) most = data.value[i];
    calls = sizeof data / sizeof(int);
}
