#include "motion/motmod/c_homing.hpp"

#include <type_traits>

#include "rtapi/base/fixed_string.hpp"

namespace kerf::motion {
namespace {

/// Of the module's calls back, which carry no context; motmod is loaded once.
struct Unlocks {
  std::uint32_t wanted{0}, is{0};  ///< a bit each joint
};
Unlocks g_unlocks;

void set_rotary_unlock(int joint, int unlock) {
  if (joint < 0 || joint >= static_cast<int>(kMaxJoints)) return;
  const std::uint32_t bit = 1U << static_cast<unsigned>(joint);
  g_unlocks.wanted = unlock != 0 ? g_unlocks.wanted | bit : g_unlocks.wanted & ~bit;
}

int get_rotary_is_unlocked(int joint) {
  if (joint < 0 || joint >= static_cast<int>(kMaxJoints)) return 0;
  return (g_unlocks.is >> static_cast<unsigned>(joint) & 1U) != 0 ? 1 : 0;
}

}  // namespace

template <class F>
bool CHoming::find(hal::Builder& b, const char* name, F& function) noexcept {
  function = reinterpret_cast<F>(b.find_c_function(name));
  if (function != nullptr) return true;
  rtapi::FixedString<160> what("motmod: the homing module does not export ");
  what.append(name);
  what.append("(), which homing.h asks for");
  b.fail(what);
  return false;
}

CHoming::CHoming(hal::Builder& b, std::int32_t joints, std::int32_t extra_joints,
                 double servo_period_s) noexcept
    : joints_(joints) {
  if (b.find_c_function("homing_init") == nullptr) return;
  const bool all =
      find(b, "homeMotFunctions", use_motion_) && find(b, "read_homing_in_pins", read_pins_) &&
      find(b, "write_homing_out_pins", write_pins_) && find(b, "do_home_joint", home_joint_) &&
      find(b, "do_cancel_homing", cancel_) && find(b, "set_unhomed", unhome_) &&
      find(b, "set_joint_homing_params", set_params_) &&
      find(b, "update_joint_homing_params", update_params_) &&
      find(b, "get_homing_is_active", is_active_) && find(b, "get_homing", homing_) &&
      find(b, "get_homed", homed_) && find(b, "homing_init", init_) &&
      find(b, "do_homing", do_homing_);
  if (!all) return;
  g_unlocks = {};
  struct Call {
    CHoming* self;
    int extra;
    double period_s;
    int answer;
  } call{this, extra_joints, servo_period_s, 0};
  b.call_c(
      [](void* object) {
        auto& c = *static_cast<Call*>(object);
        c.answer = c.self->init_(0, c.period_s, c.self->joints_, c.extra, nullptr);
        c.self->use_motion_(set_rotary_unlock, get_rotary_is_unlocked);
      },
      &call);
  if (call.answer != 0) {
    b.fail("motmod: homing_init() of the homing module failed");
    do_homing_ = nullptr;
  }
}

void CHoming::configure(const MachineConfig& config, bool all) noexcept {
  const double linear = config.linear_units_per_mm > 0 ? config.linear_units_per_mm : 1.0;
  for (int j = 0; j < joints_; ++j) {
    const JointConfig& c = config.joint[j];
    const double k = c.rotary ? 1.0 : linear;
    if (all)
      set_params_(j, c.home_offset * k, c.home * k, c.home_final_vel * k, c.home_search_vel * k,
                  c.home_latch_vel * k, c.home_flags, c.home_sequence, c.volatile_home);
    else
      update_params_(j, c.home_offset * k, c.home * k, c.home_sequence);
  }
}

void CHoming::unhome(std::int32_t joint, bool enabled, MotionMode mode) noexcept {
  // motion_state_t: disabled, free, teleop, coordinated.
  const int state = !enabled                     ? 0
                    : mode == MotionMode::free   ? 1
                    : mode == MotionMode::teleop ? 2
                                                 : 3;
  unhome_(joint, state);
}

void CHoming::set_unlocked(std::size_t joint, bool is_unlocked) noexcept {
  const std::uint32_t bit = 1U << joint;
  g_unlocks.is = is_unlocked ? g_unlocks.is | bit : g_unlocks.is & ~bit;
}

bool CHoming::wants_unlock(std::size_t joint) const noexcept {
  return (g_unlocks.wanted >> joint & 1U) != 0;
}

}  // namespace kerf::motion
