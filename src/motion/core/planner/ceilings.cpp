#include "motion/core/planner/ceilings.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "motion/core/planner/turn.hpp"

namespace kerf::motion {
namespace {

/// Rounding of unit conversion must not refuse a move to the limit itself (mm, degrees).
constexpr double kLimitTolerance = 1e-6;
/// Share of the straight-line acceleration that a curve keeps for speeding up when the feed cannot be had whole.
constexpr double kTangentialShare = 0.6;
constexpr double kSampleAngle = 0.1;  ///< rad between samples of an arc
constexpr int kMostSamples = 4096;
constexpr int kGeneralSamples = 65;  ///< of any curve under kinematics that mix axes, at least
/// Degrees of an axis or an arc between two places at which joints are looked at, and the most of these.
constexpr double kLookAngle = 4;
constexpr int kMostLooks = 50'000;
/// Of kinematics that answer later, which have room for 2048 questions at once.
constexpr int kMostAsked = 1000;
/// Between two of them joints are looked at this many times closer where they do not move evenly.
constexpr int kMostHalvings = 14;
constexpr double kJerkShare = 0.85;  ///< the same of jerk limits, with third differences
constexpr double kGeneralShare =
    0.95;  ///< of the limits used there, since differences between samples are not bounded

/// One limited quantity: a joint or an axis.
struct Row {
  double rate{0};  ///< |q'|
  double curl{0};  ///< |q''|
  double max_vel{0}, max_acc{0};
  double max_jerk{0};  ///< 0: none
  double twist{0};     ///< |q'''|; only where kinematics mix axes
};
constexpr std::size_t kRows = kMaxJoints + rtapi::kAxes;

bool is_trivial(const Kinematics& k, const MachineConfig& config) noexcept {
  for (std::int32_t j = 0; j < joints_of(k.joints(), config); ++j) {
    if (k.axis_of_joint(j) < 0) return false;
  }
  return true;
}

/// Evaluates the rows at one place of a curve.
class Sampler {
 public:
  Sampler(const Curve& curve, const Kinematics& kinematics, const MachineConfig& config,
          const JointVector& joint) noexcept
      : curve_(curve),
        kinematics_(kinematics),
        config_(config),
        begin_(joint),
        near_(joint),
        trivial_(is_trivial(kinematics, config)) {
    joint_rest_ = share_beside_offsets(config, axes_of(kinematics.axis_mask(), config));
    plan_samples();
  }

  [[nodiscard]] int samples() const noexcept { return samples_; }
  [[nodiscard]] double place(int i) const noexcept {
    return samples_ == 1 ? 0.0 : sampled_length_ * i / (samples_ - 1);
  }
  /// Share of each limit that may be used, so that the limit also holds between samples.
  [[nodiscard]] double share() const noexcept { return share_; }

  /// False: no joint position here.
  [[nodiscard]] bool rows_at(double s, Row* rows, std::size_t& count) const noexcept {
    Pose d1, d2;
    derivatives_at(curve_, s, d1, d2);
    count = 0;
    if (!joint_rows(s, d1, d2, rows, count)) return false;
    for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
      if ((axes_of(kinematics_.axis_mask(), config_) >> i & 1U) == 0) continue;
      const AxisConfig& a = config_.axis[i];
      const double rest = 1 - a.offset_av_ratio;
      rows[count] = {std::abs(d1[i]) + rate_between_[i], std::abs(d2[i]) + curl_between_[i],
                     rest * a.max_vel, rest * a.max_acc, rest * a.max_jerk};
      if (!trivial_) rows[count].twist = axis_twist(s, i);
      ++count;
    }
    return true;
  }

 private:
  void plan_samples() noexcept {
    sampled_length_ = curve_.length;
    if (!trivial_) {
      samples_ = kGeneralSamples;
      share_ = kGeneralShare;
      if (curve_.shape == Curve::Shape::arc)
        samples_ = std::max(
            samples_,
            static_cast<int>(std::min(curve_.angle / kSampleAngle, kMostSamples - 2.0)) + 2);
      return;
    }
    if (curve_.shape != Curve::Shape::arc) return;
    double angle = curve_.angle;
    if (curve_.growth == 0 && angle > 6.4) {  // one turn is like the other
      sampled_length_ *= 6.4 / angle;
      angle = 6.4;
    }
    // Samples are even in length; on a spiral the angle between them is largest at the small end.
    const double r0 = curve_.radius, r1 = curve_.radius + curve_.growth * curve_.angle;
    const double large = std::max(r0, r1), small = std::min(r0, r1);
    const double spread = curve_.growth == 0 ? angle : angle * large / small;
    samples_ = static_cast<int>(std::min(spread / kSampleAngle, kMostSamples - 2.0)) + 2;
    if (curve_.growth != 0) share_ = 0.998;
    bound_between_samples(spread / (samples_ - 1), large, small);
  }

  /// Between two samples a function passes its chord by h^2/8 of its second derivative at most; q' and q'' of an axis are
  /// sinusoids of the angle about a constant.
  void bound_between_samples(double step, double large, double small) noexcept {
    const double speed =
        std::sqrt(small * small + curve_.growth * curve_.growth + curve_.axial * curve_.axial);
    for (std::size_t i = 0; i < 3; ++i) {
      const double amplitude = large * std::hypot(curve_.radial[i], curve_.side[i]);
      rate_between_[i] = step * step / 8.0 * amplitude / speed;
      curl_between_[i] = rate_between_[i] / speed;
    }
  }

  bool joint_rows(double s, const Pose& d1, const Pose& d2, Row* rows,
                  std::size_t& count) const noexcept {
    const auto n = static_cast<std::size_t>(joints_of(kinematics_.joints(), config_));
    if (trivial_) {
      for (std::size_t j = 0; j < n; ++j) {
        const auto axis =
            static_cast<std::size_t>(kinematics_.axis_of_joint(static_cast<std::int32_t>(j)));
        const JointConfig& c = config_.joint[j];
        rows[count++] = {std::abs(d1[axis]) + rate_between_[axis],
                         std::abs(d2[axis]) + curl_between_[axis], c.max_vel, c.max_acc,
                         c.max_jerk};
      }
      return true;
    }
    const double h = curve_.length * 1e-3;
    const double mid = std::clamp(s, h, curve_.length - h);
    // From the start of the curve on, place by place.
    if (s <= last_s_) near_ = begin_;
    last_s_ = s;
    JointVector before = near_, at{}, after{};
    if (!kinematics_.inverse(point_at(curve_, mid - h), before)) return false;
    at = before;
    if (!kinematics_.inverse(point_at(curve_, mid), at)) return false;
    near_ = after = at;
    if (!kinematics_.inverse(point_at(curve_, mid + h), after)) return false;
    for (std::size_t j = 0; j < n; ++j) {
      const JointConfig& c = config_.joint[j];
      rows[count++] = {std::abs(after[j] - before[j]) / (2 * h),
                       std::abs(after[j] - 2 * at[j] + before[j]) / (h * h),
                       joint_rest_ * c.max_vel, joint_rest_ * c.max_acc, joint_rest_ * c.max_jerk};
    }
    return joint_twists(s, rows + (count - n));
  }

  /// Third differences over a step that is wide enough for them.
  bool joint_twists(double s, Row* rows) const noexcept {
    const auto n = static_cast<std::size_t>(joints_of(kinematics_.joints(), config_));
    const double h = curve_.length / kGeneralSamples;
    const double mid = std::clamp(s, 2 * h, curve_.length - 2 * h);
    JointVector q[4];
    q[0] = near_;
    for (int k = 0; k < 4; ++k) {
      if (k > 0) q[k] = q[k - 1];
      constexpr double kAt[] = {-2, -1, 1, 2};
      if (!kinematics_.inverse(point_at(curve_, mid + kAt[k] * h), q[k])) return false;
    }
    for (std::size_t j = 0; j < n; ++j)
      rows[j].twist = std::abs(q[3][j] - 2 * q[2][j] + 2 * q[1][j] - q[0][j]) / (2 * h * h * h);
    return true;
  }

  [[nodiscard]] double axis_twist(double s, std::size_t axis) const noexcept {
    const double h = curve_.length / kGeneralSamples;
    const double mid = std::clamp(s, h, curve_.length - h);
    Pose first, before, after;
    derivatives_at(curve_, mid - h, first, before);
    derivatives_at(curve_, mid + h, first, after);
    return std::abs(after[axis] - before[axis]) / (2 * h);
  }

  const Curve& curve_;
  const Kinematics& kinematics_;
  const MachineConfig& config_;
  JointVector begin_;
  mutable JointVector near_;
  mutable double last_s_{0};
  bool trivial_;
  int samples_{1};
  double sampled_length_{0};
  double share_{1};
  double joint_rest_{1};  ///< of joints that several axes move: what external offsets leave
  double rate_between_[rtapi::kAxes]{}, curl_between_[rtapi::kAxes]{};
};

/// Calls f(row) for every row of every sample. False: no solution somewhere.
template <class F>
bool for_each_row(const Sampler& sampler, F&& f) noexcept {
  Row rows[kRows];
  for (int i = 0; i < sampler.samples(); ++i) {
    std::size_t n = 0;
    if (!sampler.rows_at(sampler.place(i), rows, n)) return false;
    for (std::size_t r = 0; r < n; ++r) f(rows[r]);
  }
  return true;
}

/// The end of an interval that passes a limit, seen from where the move starts.
bool beyond_max(double high, double start, double limit) noexcept {
  return high > limit + kLimitTolerance && high > start + kLimitTolerance;
}
bool beyond_min(double low, double start, double limit) noexcept {
  return low < limit - kLimitTolerance && low < start - kLimitTolerance;
}

bool check_range(double low, double high, double start, double end, double min_limit,
                 double max_limit, Fault below, Fault above, std::size_t index,
                 FaultRecord& out) noexcept {
  const bool over =
      beyond_max(high, start, max_limit) || (end > max_limit + kLimitTolerance && end >= start);
  const bool under =
      beyond_min(low, start, min_limit) || (end < min_limit - kLimitTolerance && end <= start);
  if (!over && !under) return true;
  out.fault = over ? above : below;
  out.index = static_cast<std::int32_t>(index);
  out.value = over ? high : low;
  out.limit = over ? max_limit : min_limit;
  return false;
}

}  // namespace

PathLimits path_limits_of(const Kinematics& kinematics, const MachineConfig& config) noexcept {
  PathLimits out;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    const AxisConfig& a = config.axis[i];
    const bool exists = (axes_of(kinematics.axis_mask(), config) >> i & 1U) != 0;
    out.axes.vel[i] = exists ? a.max_vel : path::kNoLimit;
    out.axes.acc[i] = exists ? a.max_acc : path::kNoLimit;
    out.axes.jerk[i] = exists && a.max_jerk > 0 ? a.max_jerk : path::kNoLimit;
    out.low[i] = exists ? a.min_limit : -path::kNoLimit;
    out.high[i] = exists ? a.max_limit : path::kNoLimit;
  }
  for (std::int32_t j = 0; j < joints_of(kinematics.joints(), config); ++j) {
    const std::int32_t axis = kinematics.axis_of_joint(j);
    if (axis < 0) {
      out.plain = false;
      continue;
    }
    const JointConfig& c = config.joint[j];
    const auto i = static_cast<std::size_t>(axis);
    out.axes.vel[i] = std::min(out.axes.vel[i], c.max_vel);
    out.axes.acc[i] = std::min(out.axes.acc[i], c.max_acc);
    if (c.max_jerk > 0) out.axes.jerk[i] = std::min(out.axes.jerk[i], c.max_jerk);
    out.low[i] = std::max(out.low[i], c.min_limit);
    out.high[i] = std::min(out.high[i], c.max_limit);
  }
  // External offsets have their own share (external_offsets.hpp).
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    const double rest = 1 - config.axis[i].offset_av_ratio;
    out.axes.vel[i] *= rest;
    out.axes.acc[i] *= rest;
    if (out.axes.jerk[i] < path::kNoLimit) out.axes.jerk[i] *= rest;
  }
  out.axes.path_vel = config.traj_max_vel_mm_s;
  out.axes.path_acc = config.traj_max_acc_mm_s2;
  out.axes.turn_vel = config.traj_max_ang_vel_deg_s;
  if (config.traj_max_jerk_mm_s3 > 0) out.axes.path_jerk = config.traj_max_jerk_mm_s3;
  out.axes.jerks = out.axes.path_jerk < path::kNoLimit;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    out.axes.jerks = out.axes.jerks || out.axes.jerk[i] < path::kNoLimit;
  for (std::int32_t j = 0; j < joints_of(kinematics.joints(), config); ++j)
    out.axes.jerks = out.axes.jerks || config.joint[j].max_jerk > 0;
  for (std::size_t i = 0; out.axes.jerks && i < rtapi::kAxes; ++i)
    if (out.axes.acc[i] < path::kNoLimit)
      out.axes.jerk[i] = std::min(out.axes.jerk[i], out.axes.acc[i] / kSoonestAcc);
  return out;
}

namespace {

/// Jerk along the curve, and speed and acceleration lowered until each joint's q' j + 3 q'' v a + q''' v^3 keeps its limit: scaling v, a and j
/// by k, k^2 and k^3 scales the sum by k^3.
void limit_jerk(const Sampler& sampler, double traj_jerk, Ceilings& out) noexcept {
  double even = traj_jerk > 0 ? traj_jerk : 0.0;
  (void)for_each_row(sampler, [&](const Row& r) {
    if (r.max_jerk > 0 && r.rate > 0) even = least_jerk(even, kJerkShare * r.max_jerk / r.rate);
  });
  if (!(even > 0)) return;
  out.jerk = even;
  double most = 1;
  (void)for_each_row(sampler, [&](const Row& r) {
    if (!(r.max_jerk > 0)) return;
    const double sum = r.rate * even + 3 * r.curl * out.speed * out.acc +
                       r.twist * out.speed * out.speed * out.speed;
    most = std::max(most, sum / (kJerkShare * r.max_jerk));
  });
  const double k = std::cbrt(1 / most);
  out.speed *= k;
  out.acc *= k * k;
  out.jerk *= k * k * k;
}

/// How many places of a curve show what joints do along it.
int looks_at(const Curve& curve, const Pose& low, const Pose& high, bool at_once) noexcept {
  double angle = 0;
  if (curve.shape == Curve::Shape::arc) angle = curve.angle * 180 / std::numbers::pi;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    if (rtapi::is_rotary(i)) angle = std::max(angle, high[i] - low[i]);
  return std::max(kGeneralSamples, static_cast<int>(std::min<double>(
                                       angle / kLookAngle, at_once ? kMostLooks : kMostAsked)) +
                                       1);
}

/// Joints along a curve, place by place.
class JointWay {
 public:
  JointWay(const Curve& curve, const Kinematics& kinematics, std::size_t joints, int looks) noexcept
      : curve_(curve),
        kinematics_(kinematics),
        joints_(joints),
        halvings_(kinematics.answers_at_once() ? kMostLooks : std::max(kMostAsked - looks, 0) / 4),
        step_(curve.length / (looks - 1)) {}
  /// False: no joints there. `joint`: those of a place nearby, then of this one.
  [[nodiscard]] bool at(double look, JointVector& joint) const noexcept {
    return kinematics_.inverse(point_at(curve_, std::clamp(look * step_, 0.0, curve_.length)),
                               joint);
  }
  /// From the place `from`, where joints are as `joint` has them, to `to`. Next to a pole the solution that is nearest at `to` can be another one than that which the
  /// motion comes to, so it is gone to in steps in which all joints move evenly. `look`: true where joints may be as they are on the way.
  template <class F>
  [[nodiscard]] bool follow(double from, double to, JointVector& joint, F&& look,
                            int depth = kMostHalvings) noexcept {
    const double middle = 0.5 * (from + to);
    JointVector half = joint;
    if (!at(middle, half)) return false;
    JointVector end = half;
    if (!at(to, end)) return false;
    if (depth == 0 || halvings_ == 0 || evenly(joint, half, end)) {
      joint = end;
      return look(half);
    }
    --halvings_;
    return follow(from, middle, joint, look, depth - 1) &&
           follow(middle, to, joint, look, depth - 1);
  }
  /// Three places at even distances: whether joints move evenly between them.
  [[nodiscard]] bool evenly(const JointVector& a, const JointVector& b,
                            const JointVector& c) const noexcept {
    // What is closer together than kLittle (mm, degrees) is one solution.
    constexpr double kShare = 0.2, kLittle = 0.1;
    for (std::size_t j = 0; j < joints_; ++j) {
      const double one = b[j] - a[j], other = c[j] - b[j];
      if (std::abs(other - one) > kShare * std::max(std::abs(one), std::abs(other)) + kLittle)
        return false;
    }
    return true;
  }
  /// The farthest that joint j comes about `turn`, which is where it turns as the places about `look` have it.
  [[nodiscard]] double farthest(std::size_t j, double look, const Turn& turn,
                                const JointVector& near) const noexcept {
    constexpr double kNearer = 0.125;
    const double place = look + turn.at;
    JointVector q[3]{near, near, near};
    for (int k = 0; k < 3; ++k)
      if (!at(place + kNearer * (k - 1), q[k])) return turn.value;
    const Turn nearer = turn_of(q[0][j], q[1][j], q[2][j]);
    JointVector there = q[1];
    if (nearer.within && at(place + kNearer * nearer.at, there)) return there[j];
    return q[1][j];
  }

 private:
  const Curve& curve_;
  const Kinematics& kinematics_;
  std::size_t joints_;
  int halvings_;  ///< that are left for the whole curve
  double step_;
};

}  // namespace

bool ceilings_of(const Curve& curve, const Kinematics& kinematics, const MachineConfig& config,
                 const JointVector& joint, double wanted_speed, Ceilings& out) noexcept {
  const Sampler sampler(curve, kinematics, config, joint);
  double speed =
      curve.metric == FeedMetric::abc ? config.traj_max_ang_vel_deg_s : config.traj_max_vel_mm_s;
  double straight_acc = curve.metric == FeedMetric::abc ? 1e99 : config.traj_max_acc_mm_s2;
  double largest_curl = 0;
  const bool solved = for_each_row(sampler, [&](const Row& r) {
    if (r.rate > 0) {
      speed = std::min(speed, sampler.share() * r.max_vel / r.rate);
      straight_acc = std::min(straight_acc, sampler.share() * r.max_acc / r.rate);
    }
    largest_curl = std::max(largest_curl, r.curl);
  });
  if (!solved) return false;
  out = {speed, straight_acc, 0};
  const double traj_jerk = curve.metric == FeedMetric::abc ? 0.0 : config.traj_max_jerk_mm_s3;
  if (largest_curl <= 0) {
    limit_jerk(sampler, traj_jerk, out);
    return true;
  }
  const double feed = std::min(speed, wanted_speed), x = feed * feed;
  // Either the whole feed with what it leaves for speeding up, or the tangential share with what that leaves for curvature.
  const double tangential = kTangentialShare * straight_acc;
  double left = straight_acc, most = speed * speed;
  (void)for_each_row(sampler, [&](const Row& r) {
    const double usable = sampler.share() * r.max_acc;
    if (r.rate > 0)
      left = std::min(left, (usable - x * r.curl) / r.rate);
    else if (x * r.curl > usable)
      left = 0;
    if (r.curl > 0) most = std::min(most, (usable - tangential * r.rate) / r.curl);
  });
  if (left >= tangential)
    out = {feed, left, 0};
  else
    out = {std::sqrt(std::max(most, 0.0)), tangential, 0};
  limit_jerk(sampler, traj_jerk, out);
  return true;
}

bool within_soft_limits(const Curve& curve, const Kinematics& kinematics,
                        const MachineConfig& config, const double* skew, const Pose& shift,
                        JointVector& joint, FaultRecord& out) noexcept {
  Pose low, high;
  extent_of(curve, low, high);
  low = low + shift;
  high = high + shift;
  const Pose start = curve.start + shift, end = curve.end + shift;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    if ((axes_of(kinematics.axis_mask(), config) >> i & 1U) == 0 || low[i] == high[i]) continue;
    const AxisConfig& a = config.axis[i];
    if (!check_range(low[i], high[i], start[i], end[i], a.min_limit, a.max_limit,
                     Fault::axis_soft_limit_min, Fault::axis_soft_limit_max, i, out))
      return false;
  }
  const auto n = static_cast<std::size_t>(joints_of(kinematics.joints(), config));
  if (is_trivial(kinematics, config)) {
    for (std::size_t j = 0; j < n; ++j) {
      const auto i =
          static_cast<std::size_t>(kinematics.axis_of_joint(static_cast<std::int32_t>(j)));
      const JointConfig& c = config.joint[j];
      if (low[i] == high[i]) continue;
      const double k = skew[j];
      if (!check_range(low[i] + k, high[i] + k, start[i] + k, end[i] + k, c.min_limit, c.max_limit,
                       Fault::joint_soft_limit_min, Fault::joint_soft_limit_max, j, out))
        return false;
    }
    return true;
  }
  JointVector first = joint;
  if (!kinematics.inverse(curve.start, first)) return out.fault = Fault::no_inverse, false;
  const int looks = looks_at(curve, low, high, kinematics.answers_at_once());
  JointWay way(curve, kinematics, n, looks);
  const auto no_inverse = [&](int k) {
    out.fault = Fault::no_inverse;
    out.value = curve.length * k / (looks - 1);
    return false;
  };
  const auto inside = [&](std::size_t j, double q) {
    const JointConfig& c = config.joint[j];
    return check_range(q + skew[j], q + skew[j], first[j] + skew[j], q + skew[j], c.min_limit,
                       c.max_limit, Fault::joint_soft_limit_min, Fault::joint_soft_limit_max, j,
                       out);
  };
  const auto all_inside = [&](const JointVector& q) {
    for (std::size_t j = 0; j < n; ++j)
      if (!inside(j, q[j])) return false;
    return true;
  };
  JointVector before = first, here = first, at = first;
  for (int k = 1; k < looks; ++k) {
    before = here;
    here = at;
    if (!way.at(k, at)) return no_inverse(k);
    if (k == 1 || !way.evenly(before, here, at)) {
      at = here;
      if (!way.follow(k - 1, k, at, all_inside))
        return out.fault != Fault::none ? false : no_inverse(k);
    }
    for (std::size_t j = 0; j < n; ++j) {
      if (!inside(j, at[j])) return false;
      const Turn turn = k > 1 ? turn_of(before[j], here[j], at[j]) : Turn{};
      if (!turn.within) continue;
      // Between the places it may come farther than at them.
      const JointConfig& c = config.joint[j];
      const double low_most = turn.value + skew[j] - turn.doubt,
                   high_most = turn.value + skew[j] + turn.doubt;
      if ((low_most < c.min_limit || high_most > c.max_limit) &&
          !inside(j, way.farthest(j, k - 1, turn, here)))
        return false;
    }
  }
  joint = at;
  return true;
}

}  // namespace kerf::motion
