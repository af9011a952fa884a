component filter3 "Median of the last three, in C++";
option cxx;
pin in float in;
pin out float out;
pin out float mean;
pin out s32 each-#[2 : personality];
variable int calls = 0;
function _;
include <algorithm>;
include <array>;
license "GPL";
;;
namespace {
template <class T, std::size_t N>
class Last {
 public:
  void put(T v) noexcept { values_[at_++ % N] = v; }
  T middle() const noexcept { auto copy = values_; std::sort(copy.begin(), copy.end()); return copy[N / 2]; }
 private:
  std::array<T, N> values_{};
  std::size_t at_{0};
};
Last<double, 3> last;
}
FUNCTION(_) {
  last.put(in);
  out = last.middle();
  calls = std::min(calls + 1, 50);
  if (personality > 1) each(1) = calls;
}
