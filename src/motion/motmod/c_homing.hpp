// Homing by a module in C, [EMCMOT]HOMEMOD: one that exports do_homing and its companions (src/hal/capi/include/homing.h).
#pragma once

#include <cstdint>

#include "hal/component.hpp"
#include "motion/api/config.hpp"
#include "motion/core/homing_module.hpp"

namespace kerf::motion {

class CHoming final : public HomingModule {
 public:
  /// Found or not, see found(); a module that exports some of the calls alone, or that refuses, fails the builder.
  CHoming(hal::Builder& b, std::int32_t joints, std::int32_t extra_joints,
          double servo_period_s) noexcept;
  [[nodiscard]] bool found() const noexcept { return do_homing_ != nullptr; }

  /// [JOINT_n]HOME and its companions, in machine units as such modules have them. `all`: else only those that may change at any time.
  void configure(const MachineConfig& config, bool all) noexcept;

  void read_pins() noexcept override { read_pins_(joints_); }
  void write_pins() noexcept override { write_pins_(joints_); }
  void step() noexcept override { (void)do_homing_(); }
  void start(std::int32_t joint) noexcept override { home_joint_(joint); }
  void cancel(std::int32_t joint) noexcept override { cancel_(joint); }
  void unhome(std::int32_t joint, bool enabled, MotionMode mode) noexcept override;
  [[nodiscard]] bool active() const noexcept override { return is_active_(); }
  [[nodiscard]] bool homing(std::size_t joint) const noexcept override {
    return homing_(static_cast<int>(joint));
  }
  [[nodiscard]] bool homed(std::size_t joint) const noexcept override {
    return homed_(static_cast<int>(joint));
  }
  void set_unlocked(std::size_t joint, bool is_unlocked) noexcept override;
  [[nodiscard]] bool wants_unlock(std::size_t joint) const noexcept override;

 private:
  template <class F>
  bool find(hal::Builder& b, const char* name, F& function) noexcept;

  int joints_;
  int (*init_)(int, double, int, int, void*){nullptr};
  void (*use_motion_)(void (*)(int, int), int (*)(int)){nullptr};
  void (*read_pins_)(int){nullptr};
  void (*write_pins_)(int){nullptr};
  bool (*do_homing_)(){nullptr};
  void (*home_joint_)(int){nullptr};
  void (*cancel_)(int){nullptr};
  void (*unhome_)(int, int){nullptr};
  void (*set_params_)(int, double, double, double, double, double, int, int, bool){nullptr};
  void (*update_params_)(int, double, double, int){nullptr};
  bool (*is_active_)(){nullptr};
  bool (*homing_)(int){nullptr};
  bool (*homed_)(int){nullptr};
};

}  // namespace kerf::motion
