component turret8 "A tool turret of eight places: unlock, index, lock";
pin in s32 wanted "Place to go to, 1 to 8";
pin in bit start "Begins a change";
pin out bit unlock "Valve";
pin out bit index_ "Motor";
pin in bit locked = 1 "Switch";
pin out bit done "True when the wanted place is locked";
pin out s32 place = 1 "Where it is";
pin out bit fault;
param rw float step_time = 0.005 "Time from place to place [s]";
param rw float timeout = 5;
param r s32 state;
variable double t = 0;
variable int before = 0;
function _;
license "GPL";
;;
enum { IDLE, UNLOCKING, TURNING, LOCKING, FAULT };
static int next(int p) { return p % 8 + 1; }
FUNCTION(_) {
    t += fperiod;
    switch (state) {
    case IDLE:
        if (start && !before) { done = 0; unlock = 1; t = 0; state = wanted < 1 || wanted > 8 ? FAULT : UNLOCKING; }
        break;
    case UNLOCKING:
        if (t > step_time) { index_ = place != wanted; t = 0; state = TURNING; }
        break;
    case TURNING:
        if (place == wanted) { index_ = 0; unlock = 0; t = 0; state = LOCKING; break; }
        if (t > step_time) { place = next(place); t = 0; }
        break;
    case LOCKING:
        if (locked) { done = 1; state = IDLE; }
        else if (t > timeout) state = FAULT;
        break;
    default:
        fault = 1; unlock = 0; index_ = 0;
    }
    before = start;
}
