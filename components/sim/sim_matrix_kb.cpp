// sim_matrix_kb: simulates the codes of a matrix keyboard.
#include "hal/component.hpp"

namespace kerf::components {

class SimMatrixKb final : public hal::Component<SimMatrixKb> {
 public:
  static constexpr hal::Info kInfo{
      .name = "sim-matrix-kb",
      .summary = "Simulates the codes of a matrix keyboard",
      .notes =
          "A key that changes gives its code for one call: row * 8 + column, and 0xC0 for a press "
          "or 0x80 for a release; between, 0x40 says that a key is pressed and 0 that none is. "
          "Feed out to the keycode of matrix_kb."};

  explicit SimMatrixKb(hal::Builder& b) noexcept : Component(b) {
    for (std::size_t column = 0; column < 8; ++column) {
      for (std::size_t row = 0; row < 8; ++row) {
        hal::Name name = hal::numbered("button.c##", column);
        name.append(hal::numbered(".r##", row));
        keys_[column][row].declare(b, b.full_name(name), "True while this key is pressed");
      }
    }
  }

 private:
  hal::Out<std::uint32_t> out_{
      pin<hal::Out<std::uint32_t>>("out", "Code of the key that has changed last")};
  hal::In<bool> keys_[8][8]{};
  bool before_[8][8]{};
  std::uint32_t pressed_{0};

  void update(const hal::Period&) noexcept {
    for (std::uint32_t row = 0; row < 8; ++row) {
      for (std::uint32_t column = 0; column < 8; ++column) {
        const bool now = keys_[column][row];
        bool& before = before_[column][row];
        if (now == before) continue;
        before = now;
        pressed_ += now ? 1U : ~0U;
        out_ = (now ? 0xC0U : 0x80U) | row << 3U | column;
        return;
      }
    }
    out_ = pressed_ > 0 ? 0x40U : 0U;
  }
  hal::Function update_{function<&SimMatrixKb::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::SimMatrixKb)
