// HomingModule: homing by somebody else, [EMCMOT]HOMEMOD. @rt
#pragma once

#include <cstddef>
#include <cstdint>

#include "motion/api/intent.hpp"

namespace kerf::motion {

/// It says which joints are homed and which it homes. While it homes a joint, the joint's command follows its feedback: the drive
/// moves by itself. A homed joint stands where its motor says.
class HomingModule {
 public:
  HomingModule() = default;
  HomingModule(const HomingModule&) = delete;
  HomingModule& operator=(const HomingModule&) = delete;

  /// Each cycle, first of all and last of all.
  virtual void read_pins() noexcept = 0;
  virtual void write_pins() noexcept = 0;
  /// A cycle of joint mode with the machine on.
  virtual void step() noexcept = 0;
  /// -1: all joints.
  virtual void start(std::int32_t joint) noexcept = 0;
  virtual void cancel(std::int32_t joint) noexcept = 0;
  /// -1: all joints, -2: those with VOLATILE_HOME.
  virtual void unhome(std::int32_t joint, bool enabled, MotionMode mode) noexcept = 0;
  [[nodiscard]] virtual bool active() const noexcept = 0;
  [[nodiscard]] virtual bool homing(std::size_t joint) const noexcept = 0;
  [[nodiscard]] virtual bool homed(std::size_t joint) const noexcept = 0;
  /// For locking indexers: what the joint's pins say, and what they shall.
  virtual void set_unlocked(std::size_t joint, bool is_unlocked) noexcept = 0;
  [[nodiscard]] virtual bool wants_unlock(std::size_t joint) const noexcept = 0;

 protected:
  ~HomingModule() = default;
};

}  // namespace kerf::motion
