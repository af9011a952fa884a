component mean_of_4 "old data option";
option data struct_of_mine;
pin in float in;
pin out float out;
function _;
license "GPL";
;;
typedef struct { double old[4]; int at; } struct_of_mine;
FUNCTION(_) {
  struct_of_mine *d = (struct_of_mine*)&data;
  int i; double s = 0;
  d->old[d->at++ & 3] = in;
  for (i = 0; i < 4; i++) s += d->old[i];
  out = s / 4;
}
