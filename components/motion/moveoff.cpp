// moveoff: offsets of joints while a program is paused.
#include <algorithm>
#include <cmath>

#include "hal/component.hpp"
#include "hal/operator_line.hpp"
#include "rtapi/base/limited.hpp"

namespace kerf::components {

class Moveoff final : public hal::Component<Moveoff> {
 public:
  static constexpr hal::Info kInfo{
      .name = "moveoff",
      .summary = "Offsets of joints while a program is paused",
      .notes =
          "personality= is the number of joints, at most 9 (default 3). While power-on, "
          "apply-offsets and move-enable are true each joint goes to its offset-in, within its "
          "limits of value, speed and acceleration. When either of the enables goes, the offsets "
          "go back to zero: along the recorded waypoints in reverse order with backtrack-enable, "
          "else each joint on its own way. When the memory for waypoints is used up the offsets "
          "stop until an enable goes. Offsets that are taken back because apply-offsets went set "
          "warning and say so."};

  explicit Moveoff(hal::Builder& b) noexcept
      : Component(b),
        line_(static_cast<const hal::OperatorLine*>(b.find_service(hal::kOperatorLine))) {
    const std::int64_t joints = b.personality() > 0 ? b.personality() : 3;
    if (joints > static_cast<std::int64_t>(kMostJoints)) {
      b.fail("personality= must be from 1 to 9");
      return;
    }
    joints_ = hal::make_array<Joint>(b, static_cast<std::size_t>(joints));
  }

 private:
  static constexpr std::size_t kMostJoints = 9;
  static constexpr std::size_t kWaypoints = 1024;
  enum class State : std::uint8_t { idle, applies, returns };
  struct Joint {
    Joint(hal::Builder& b, std::size_t index) noexcept {
      const auto name = [&](const char* pattern) {
        return b.full_name(hal::numbered(pattern, index));
      };
      wanted.declare(b, name("offset-in-#"), "Wanted offset of the joint");
      pos.declare(b, name("pos-#"), "Commanded position of the joint");
      fb.declare(b, name("fb-#"), "Position of the joint");
      current.declare(b, name("offset-current-#"), "Offset of the joint");
      pos_out.declare(b, name("pos-plusoffset-#"), "Commanded position with the offset");
      fb_out.declare(b, name("fb-minusoffset-#"), "Position without the offset");
      max_speed.declare(b, name("offset-vel-#"), "Highest speed of the offset [units per second]",
                        10.0);
      max_accel.declare(b, name("offset-accel-#"),
                        "Highest acceleration of the offset [units per second^2]", 100.0);
      min.declare(b, name("offset-min-#"), "Lowest offset", -1e20);
      max.declare(b, name("offset-max-#"), "Highest offset", 1e20);
    }
    [[nodiscard]] double lowest() const noexcept { return min; }
    [[nodiscard]] double highest() const noexcept { return std::max(min.get(), max.get()); }
    /// One period towards `target`. True when it is there and stands.
    bool move(double target, double dt) noexcept {
      const double step = std::max(std::fabs(max_accel.get()) * dt, 1e-12),
                   missing = target - offset;
      if (std::fabs(missing) <= step * dt * 0.5 && std::fabs(speed) <= step) {
        offset = target;
        speed = 0.0;
        return true;
      }
      double next = std::copysign(
          std::sqrt(2.0 * std::fabs(max_accel.get() * missing) + 0.25 * step * step) - 0.5 * step,
          missing);
      next = std::copysign(std::min(std::fabs(next), std::fabs(missing) / dt), missing);
      next = rtapi::limited(next, -std::fabs(max_speed.get()), std::fabs(max_speed.get()));
      speed = rtapi::limited(next, speed - step, speed + step);
      offset += speed * dt;
      return false;
    }
    hal::In<double> wanted, pos, fb, max_speed, max_accel, min, max;
    hal::Out<double> current, pos_out, fb_out;
    double offset{0.0}, speed{0.0};
    float trail[kWaypoints]{};
  };

  hal::In<bool> power_on_{pin<hal::In<bool>>("power-on", "From motion.motion-enabled")};
  hal::In<bool> move_enable_{
      pin<hal::In<bool>>("move-enable", "True, with apply-offsets, applies the offsets")};
  hal::In<bool> apply_offsets_{
      pin<hal::In<bool>>("apply-offsets", "True, with move-enable, applies the offsets")};
  hal::In<bool> backtrack_enable_{
      pin<hal::In<bool>>("backtrack-enable", "True: back along the waypoints", true)};
  hal::In<double> epsilon_{pin<hal::In<double>>(
      "epsilon", "Offset that counts as zero on the way back, at least 0.0001", 0.0005)};
  hal::In<double> waypoint_threshold_{pin<hal::In<double>>(
      "waypoint-threshold", "Shortest way of a joint between waypoints", 0.02)};
  hal::In<double> waypoint_sample_secs_{
      pin<hal::In<double>>("waypoint-sample-secs", "Shortest time between waypoints [s]", 0.02)};
  hal::Out<bool> warning_{pin<hal::Out<bool>>(
      "warning", "True when apply-offsets went while there were offsets, until they are gone")};
  hal::Out<bool> offset_applied_{
      pin<hal::Out<bool>>("offset-applied", "True while there is an offset")};
  hal::Out<bool> waypoint_limit_{
      pin<hal::Out<bool>>("waypoint-limit", "True: no room for waypoints, nothing moves", false)};
  hal::Out<std::int32_t> waypoint_ct_{
      pin<hal::Out<std::int32_t>>("waypoint-ct", "Waypoints on record")};
  hal::Out<std::int32_t> waypoint_percent_used_{pin<hal::Out<std::int32_t>>(
      "waypoint-percent-used", "Room for waypoints that is used [percent]")};
  hal::In<bool> dbg_waypoint_limit_test_{
      pin<hal::In<bool>>("dbg-waypoint-limit-test", "True: room for ten waypoints only")};
  hal::Out<std::int32_t> dbg_state_{pin<hal::Out<std::int32_t>>(
      "dbg-state", "At the start of the cycle: 0 idle, 1 applies, 2 goes back")};
  hal::Array<Joint> joints_;

  void read_inputs(const hal::Period& period) noexcept {
    // What is measured now follows the offset of the last cycle.
    for (Joint& j : joints_) j.fb_out = j.fb - j.offset;
    const double dt = period.seconds();
    dbg_state_ = static_cast<std::int32_t>(state_);
    const bool enable = power_on_ && move_enable_ && apply_offsets_;
    if (state_ == State::idle) {
      epsilon_now_ = std::max(epsilon_.get(), 1e-4);
      threshold_ = waypoint_threshold_;
      sample_s_ = waypoint_sample_secs_;
      if (enable) {
        state_ = State::applies;
        waypoints_ = 0;
        since_s_ = 0.0;
        full_ = false;
        record();
      }
    } else if (state_ == State::applies && !enable) {
      state_ = State::returns;
      if (!apply_offsets_) {
        warning_ = true;
        if (line_ != nullptr && offset_applied_.last())
          line_->error(
              "moveoff: apply-offsets went while offsets are applied, they go back to zero");
      }
      full_ = false;
      if (waypoints_ > 0) --waypoints_;  // of the place where it is
    } else if (state_ == State::returns && enable) {
      state_ = State::applies;
      record();
    }
    if (!power_on_) {
      for (Joint& j : joints_) j.speed = 0.0;
    } else if (state_ == State::applies) {
      for (Joint& j : joints_) {
        if (!full_) j.move(rtapi::limited(j.wanted.get(), j.lowest(), j.highest()), dt);
      }
      since_s_ += dt;
      if (since_s_ >= sample_s_ && moved()) record();
    } else if (state_ == State::returns) {
      go_back(dt);
    }
    bool applied = false;
    for (const Joint& j : joints_) applied = applied || std::fabs(j.offset) > epsilon_now_;
    offset_applied_ = applied;
    if (!applied || apply_offsets_) warning_ = false;
    waypoint_limit_ = full_;
    waypoint_ct_ = static_cast<std::int32_t>(waypoints_);
    waypoint_percent_used_ = static_cast<std::int32_t>(100 * waypoints_ / kWaypoints);
  }
  hal::Function read_inputs_{
      function<&Moveoff::read_inputs>("read-inputs", "Computes the offsets")};

  void write_outputs(const hal::Period&) noexcept {
    for (Joint& j : joints_) {
      j.current = j.offset;
      j.pos_out = j.pos + j.offset;
    }
  }
  hal::Function write_outputs_{function<&Moveoff::write_outputs>(
      "write-outputs", "Writes the positions with their offsets")};

  void record() noexcept {
    const std::size_t room = dbg_waypoint_limit_test_ ? 10 : kWaypoints;
    if (waypoints_ >= room) {
      full_ = true;
      for (Joint& j : joints_) j.speed = 0.0;
      return;
    }
    for (Joint& j : joints_) j.trail[waypoints_] = static_cast<float>(j.offset);
    ++waypoints_;
    since_s_ = 0.0;
  }
  /// Whether a joint is far enough from the last waypoint.
  [[nodiscard]] bool moved() noexcept {
    if (waypoints_ == 0) return true;
    for (const Joint& j : joints_) {
      if (std::fabs(j.offset - static_cast<double>(j.trail[waypoints_ - 1])) > threshold_)
        return true;
    }
    return false;
  }
  void go_back(double dt) noexcept {
    const bool along = backtrack_enable_ && waypoints_ > 0;
    bool there = true;
    for (Joint& j : joints_)
      there = j.move(along ? static_cast<double>(j.trail[waypoints_ - 1]) : 0.0, dt) && there;
    if (!there) return;
    if (along) {
      --waypoints_;
    } else {
      waypoints_ = 0;
      state_ = State::idle;
    }
  }
  const hal::OperatorLine* line_;
  State state_{State::idle};
  std::size_t waypoints_{0};
  double epsilon_now_{0.0005}, threshold_{0.02}, sample_s_{0.02}, since_s_{0.0};
  bool full_{false};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Moveoff)
