// G0, G1, G4, G38.2-G38.5, G53, G80. Manual: "G0 Rapid Move", "G1 Linear Move", "G4 Dwell", "G38.n Straight Probe".
#include <algorithm>
#include <cmath>

#include "interp/codes/families.hpp"

namespace kerf::interp {

void feed_length(const Pose& from, const Pose& to, double& linear_mm, double& angular_deg) {
  const Pose d = to - from;
  linear_mm = std::hypot(d.x, d.y, d.z);
  if (linear_mm < 1e-9) linear_mm = std::hypot(d.u, d.v, d.w);
  angular_deg = linear_mm < 1e-9 ? std::hypot(d.a, d.b, d.c) : 0;
}

bool check_feed(Core& c, const Block& b, const char* what, const char* zero_feed) {
  const ModalState& s = c.state;
  if (s.feed_mode == ProgramFeedMode::inverse_time) {
    if (!b.has('f'))
      return c.fail(0, "G93 needs an F on each line that moves: 1 over the minutes of the move",
                    "F word missing with inverse time %s move", what);
    return b['f'] != 0 || c.fail('f', "Write F greater than 0", "%s", zero_feed);
  }
  if (s.feed == 0) return c.fail(0, "Write F with a feed, here or before", "%s", zero_feed);
  if (s.feed_mode == ProgramFeedMode::per_revolution &&
      s.speed_rpm[static_cast<std::size_t>(s.feed_spindle)] == 0)
    return c.fail(0, "Set a spindle speed first",
                  "Cannot feed with zero spindle speed in feed per rev mode");
  return true;
}

/// Moves of nearly no length would take for ever; the peer's limit, in units or degrees a minute.
constexpr double kLeastFeed = 0.1;

void inverse_time_feed(Core& c, const Block& b, double linear_mm, double angular_deg) {
  if (c.state.feed_mode != ProgramFeedMode::inverse_time) return;
  const double rate = b['f'];
  const double linear = std::max(linear_mm * rate, c.mm(kLeastFeed));
  const double angular = std::max(angular_deg * rate, kLeastFeed);
  c.out.call<&Canon::set_feed_rate>(linear_mm < 1e-9 ? c.mm(angular) : linear, angular);
}

/// In the peer's words: exact path around it.
void index_traverse(Core& c, const Pose& end) {
  const ModalState& s = c.state;
  const bool exact = s.path == PathMode::exact_path;
  if (!exact) c.out.call<&Canon::set_motion_control_mode>(PathMode::exact_path, 0.0);
  c.out.call<&Canon::straight_traverse>(end);
  if (exact) return;
  const bool blends = s.path == PathMode::continuous;
  c.out.call<&Canon::set_motion_control_mode>(s.path, blends ? s.tolerance_mm : 0.0);
  c.out.call<&Canon::set_naivecam_tolerance>(s.naivecam_tolerance_mm);
}

namespace {

bool straight(Core& c, const Block& b, int code) {
  // Without axis words: a move to where the machine stands, which sets the motion mode.
  Pose end;
  if (!c.target(b, end)) return false;
  const bool bends = c.compensation.bends();
  if (c.compensation.leaving()) c.compensation.left();
  if (code == 0) {
    bool index = false;
    for (std::size_t i = 0; i < rtapi::kAxes; ++i)
      index = index || (b.has_axis(i) && (c.settings.indexer_mask >> i & 1U) != 0);
    if (index)
      index_traverse(c, end);
    else if (!bends)
      c.out.call<&Canon::straight_traverse>(end);
  } else {
    if (!check_feed(c, b, "g1", "Cannot do g1 with zero feed rate")) return false;
    if (c.state.feed_mode == ProgramFeedMode::inverse_time) {
      double linear = 0, angular = 0;
      feed_length(c.state.position, end, linear, angular);
      inverse_time_feed(c, b, linear, angular);
    }
    if (!bends) c.out.call<&Canon::straight_feed>(end);
  }
  if (bends && !c.compensation.straight(end, code == 0)) return false;
  c.state.position = end;
  c.state.motion = code;
  return true;
}

bool probe(Core& c, const Block& b, int code) {
  if (c.state.feed_mode == ProgramFeedMode::per_revolution)
    return c.fail(0, "Write G94 and F before", "Cannot probe with feed per rev mode");
  if (!check_feed(c, b, "probe", "Cannot probe with zero feed rate")) return false;
  Pose end;
  if (!c.target(b, end)) return false;
  double linear = 0, angular = 0;
  feed_length(c.state.position, end, linear, angular);
  // G38.3 and G38.5 there are no error where nothing is met; programs in the field go on from there.
  const bool must_meet = code == 382 || code == 384;
  if (must_meet && std::max(linear, angular) < 1e-9)
    return c.fail(0, "Probe from further away", "Start point too close to probe point");
  inverse_time_feed(c, b, linear, angular);
  c.out.call<&Canon::turn_probe_on>();
  c.out.call<&Canon::straight_probe>(end, static_cast<ProbeKind>(code - 382));
  c.out.call<&Canon::turn_probe_off>();
  c.state.position = end;
  c.state.motion = code;
  c.ask_sync(SyncReason::probe);
  return true;
}

bool dwell(Core& c, const Block& b, int) {
  if (!b.has('p') || b['p'] < 0)
    return c.fail('p', "Write P with seconds, 0 or more", "Dwell time missing with g4");
  c.out.call<&Canon::dwell>(b['p']);
  return true;
}

bool cancel_motion(Core& c, const Block&, int) {
  c.comment("interpreter: motion mode set to none");
  c.state.motion = 800;
  return true;
}

constexpr CodeRow kRows[] = {
    {'g', 0, 0, 1, kOrderMotion, straight, 0, AxisUse::optional},
    {'g', 10, 10, 1, kOrderMotion, straight, 0, AxisUse::optional},
    {'g', 40, 40, 0, kOrderDwell, dwell, letters("p"), AxisUse::none},
    {'g', 382, 385, 1, kOrderMotion, probe, 0, AxisUse::required},
    // Only changes where G0 and G1 go (Core::target).
    {'g', 530, 530, 0, 0, nullptr, 0, AxisUse::none},
    {'g', 800, 800, 1, kOrderMotion, cancel_motion, 0, AxisUse::none},
};

}  // namespace

std::span<const CodeRow> motion_codes() { return kRows; }

}  // namespace kerf::interp
