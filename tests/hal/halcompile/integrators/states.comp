component states "enum, struct, switch and goto in the code; names with dots";
pin in bit cmd.start; pin in bit cmd.stop-now; pin out bit lamp.0; pin out u32 state.now = 0;
param rw u32 limit.time = 5;
variable int s; variable int t;
function _;
license "GPL";
;;
enum { IDLE, RUN, DONE };
FUNCTION(_) {
  switch (s) {
    case IDLE: if (cmd_start) { s = RUN; t = 0; } break;
    case RUN: if (cmd_stop_now) goto end; if (++t >= (int)limit_time) s = DONE; break;
    case DONE: if (!cmd_start) s = IDLE; break;
    default: end: s = IDLE;
  }
  state_now = s; lamp_0 = s == RUN;
}
