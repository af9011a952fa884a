// hang: its function never returns, as a driver that waits for hardware which is gone.
#include <unistd.h>

#include "hal/component.hpp"
#include "rtapi/sync/cell.hpp"

namespace kerf::hal::test {

class Hang final : public Component<Hang> {
 public:
  static constexpr Info kInfo{.name = "hang", .summary = "Never returns"};
  using Component::Component;

 private:
  rtapi::StopWord never_;
  Out<bool> hangs_{pin<Out<bool>>("hangs", "True from when it hangs")};
  void update(const Period&) noexcept {
    hangs_ = true;
    while (!never_.requested()) ::pause();
  }
  Function update_{function<&Hang::update>("", "Never returns")};
};

}  // namespace kerf::hal::test

using kerf::hal::test::Hang;
KERF_HAL_MODULE(Hang)
