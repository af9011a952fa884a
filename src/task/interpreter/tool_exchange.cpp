// Another tool in the spindle, in the middle of a held path. What motion has already stays as it is: the path as a whole is driven
// as far beside its coordinates as the new tool is longer, and what is read from then on is turned into these coordinates. So the
// tip goes on along the same path, through arcs and corners. What would not be right then is refused here, with the reason.
#include <algorithm>
#include <cmath>

#include "task/api/number_text.hpp"
#include "task/interpreter/interpreter_participant.hpp"

namespace kerf::task {
namespace {

constexpr double kSame = 1e-9;     ///< mm, degrees
constexpr double kAtLimit = 1e-6;  ///< mm, degrees
constexpr int kG43 = 430, kG40 = 400, kG49 = 490;

bool same(const motion::Pose& a, const motion::Pose& b) {
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    if (std::fabs(a[i] - b[i]) > kSame) return false;
  return true;
}

bool cuts_alike(const io::ToolEntry& a, const io::ToolEntry& b) {
  return std::fabs(a.diameter_mm - b.diameter_mm) <= kSame && a.orientation == b.orientation;
}

std::string line_of(const motion::SourceTag& tag) {
  return tag.line > 0 ? "line " + std::to_string(tag.line) : std::string("the line in execution");
}

/// The way on when the path itself cannot be driven with the new tool.
constexpr const char* kElse = "; abort, correct the tool table, then run LINE";

/// Calls f for each position that the item has.
template <class F>
void each_place(PathBody& body, F&& f) {
  if (auto* m = std::get_if<motion::LinearMove>(&body)) f(m->end);
  if (auto* m = std::get_if<motion::CubicMove>(&body)) f(m->end);
  if (auto* m = std::get_if<motion::ProbeMove>(&body)) f(m->end);
  if (auto* m = std::get_if<motion::SyncMove>(&body)) f(m->end);
  if (auto* m = std::get_if<motion::TapMove>(&body)) f(m->end);
  if (auto* m = std::get_if<motion::ToolOffset>(&body)) f(m->offset);
  if (auto* m = std::get_if<motion::ArcMove>(&body)) {
    f(m->end);
    motion::Pose centre{m->centre[0], m->centre[1], m->centre[2]};
    f(centre);
    for (std::size_t i = 0; i < 3; ++i) m->centre[i] = centre[i];
  }
}

}  // namespace

void InterpreterParticipant::place_items(std::size_t from) {
  if (shift_ == motion::Pose{}) return;
  for (std::size_t i = from; i < list_.size(); ++i)
    if (auto* body = std::get_if<PathBody>(&list_[i].body))
      each_place(*body, [this](motion::Pose& p) { p = p - shift_; });
}

/// Of arcs the whole circle, of curves all that is as near as they are long: a little too much refuses early, never late.
void InterpreterParticipant::note_extent(std::size_t from, std::size_t to,
                                         BlockRecord& record) const {
  for (std::size_t i = from; i < to; ++i) {
    const auto* body = std::get_if<PathBody>(&list_[i].body);
    if (body == nullptr || std::holds_alternative<motion::ToolOffset>(*body)) continue;
    const auto take = [&record](std::size_t axis, double at) {
      record.low[axis] = std::min(record.low[axis], at);
      record.high[axis] = std::max(record.high[axis], at);
    };
    PathBody copy = *body;
    const auto* arc = std::get_if<motion::ArcMove>(body);
    if (arc == nullptr) {
      const auto* cubic = std::get_if<motion::CubicMove>(body);
      const double around = cubic != nullptr ? cubic->length : 0;
      each_place(copy, [&](const motion::Pose& p) {
        for (std::size_t a = 0; a < rtapi::kAxes; ++a)
          take(a, p[a] - around), take(a, p[a] + around);
      });
    } else {
      double across = 0, along = 0;  // of the end from the axis
      for (std::size_t a = 0; a < 3; ++a) along += (arc->end[a] - arc->centre[a]) * arc->normal[a];
      for (std::size_t a = 0; a < 3; ++a) {
        const double d = arc->end[a] - arc->centre[a] - along * arc->normal[a];
        across += d * d;
      }
      // A spiral that gets narrower begins wider: the block before ends there.
      for (std::size_t a = 0; a < rtapi::kAxes; ++a) take(a, arc->end[a]);
      for (std::size_t a = 0; a < 3; ++a) {
        const double reach = std::sqrt(across * std::max(0.0, 1 - arc->normal[a] * arc->normal[a]));
        if (reach <= kSame) continue;
        const double middle = arc->centre[a] + along * arc->normal[a];
        take(a, middle - reach);
        take(a, middle + reach);
      }
    }
    record.machine_place =
        record.machine_place ||
        (std::holds_alternative<motion::LinearMove>(*body) &&
         std::get<motion::LinearMove>(*body).kind == motion::MotionKind::tool_change);
  }
}

std::string InterpreterParticipant::why_no_exchange(std::int32_t tool, io::ToolEntry& entry,
                                                    motion::Pose& change) {
  const std::int32_t old_number = p_.io.state().tool_in_spindle;
  if (!run_.active || run_.failed || seek_) return "nothing runs whose tool could be exchanged";
  if (!status_.shifts_path)
    return "the kinematics mix axes, and the path was planned with the tool as it was" +
           std::string(kElse);
  if (status_.retraces)
    return "the path was turned back, and what lies ahead up to there was cut with the tool as it "
           "was; resume forwards until the machine is there again" +
           std::string(kElse);
  if (tool_order_ != 0 || exchange_order_ != 0)
    return "the tool changer is at work; wait until it has ended";
  if (old_number <= 0) return "no tool is in the spindle";
  const interp::ModalState& modal = history_.present().modal;
  if (modal.tool_offset_code != kG43)
    return modal.tool_offset_code == kG49
               ? "no tool length offset is in force (G49): the path knows nothing of the tool's "
                 "length, so the new tool must be exactly as long" +
                     std::string(kElse)
               : "the program sets the tool length offset itself (G43.1, G43.2)" +
                     std::string(kElse);
  const motion::Pose present = modal.frame.tool();
  const auto before = p_.tools.table();
  const io::ToolEntry* old = before->find(old_number);
  if (old == nullptr || !same(old->offset, present))
    return "the tool length offset in force is not that of tool " + std::to_string(old_number) +
           " in the spindle" + kElse;
  std::string why;
  bool compensates = interp_.waiting();
  history_.each([&](const BlockRecord& r) {
    compensates = compensates || r.modal.cutter_comp != kG40;
    if (!why.empty()) return;
    if (r.machine_place)
      why = line_of(r.tag) +
            " goes to a place in machine coordinates (G53, G28, G30, a tool change) and is read "
            "already: exchange the tool behind it";
    else if (r.tool_awaited || !same(r.canon.frame.tool(), present))
      why = line_of(r.tag) +
            " changes the tool or its offset and is read already: exchange the tool behind it";
  });
  if (!why.empty()) return why + kElse;
  if (auto loaded = p_.tools.load(); !loaded.ok()) return loaded.error().message();
  const auto table = p_.tools.table();
  const io::ToolEntry* found = table->find(tool);
  if (found == nullptr) return "tool " + std::to_string(tool) + " is not in the tool table";
  if (compensates && !cuts_alike(*old, *found))
    return "with cutter compensation (G41, G42) the path was computed for a diameter of " +
           task::number(old->diameter_mm) + " mm and an orientation of " +
           std::to_string(old->orientation) + "; the new tool has " +
           task::number(found->diameter_mm) + " mm and " + std::to_string(found->orientation) +
           kElse;
  entry = *found;
  change = entry.offset - present;
  const auto beyond = [&](std::size_t a, double at, const std::string& where) {
    const auto& limits = p_.setup.motion.axis[a];
    if (!why.empty() || std::fabs(change[a]) <= kSame) return;
    if (at <= limits.max_limit + kAtLimit && at >= limits.min_limit - kAtLimit) return;
    why = "with the new tool " + where + " would bring " + rtapi::kAxisLetters[a] + " to " +
          task::number(at) + ", beyond its limit of " +
          task::number(at > limits.max_limit ? limits.max_limit : limits.min_limit);
  };
  for (std::size_t a = 0; a < rtapi::kAxes; ++a)
    beyond(a, status_.place[a] + change[a], "the way back to the path");
  history_.each([&](const BlockRecord& r) {
    for (std::size_t a = 0; a < rtapi::kAxes; ++a) {
      if (r.low[a] > r.high[a]) continue;
      beyond(a, r.low[a] + change[a], line_of(r.tag));
      beyond(a, r.high[a] + change[a], line_of(r.tag));
    }
  });
  return why;
}

bool InterpreterParticipant::exchange_tools() {
  if (exchange_order_ != 0) {
    const io::IoState io = p_.io.state();
    if (io.finished_order >= exchange_order_) {
      exchange_order_ = 0;
      interp_.set_tool_in_spindle(io.tool_in_spindle, io.pocket_in_spindle);
    }
  }
  ToolExchange asked;
  if (!p_.exchange.take(asked)) return false;
  const std::int32_t old_number = p_.io.state().tool_in_spindle;
  const std::int32_t number = asked.tool >= 0 ? asked.tool : old_number;
  io::ToolEntry entry;
  motion::Pose change;
  const std::string why = why_no_exchange(number, entry, change);
  if (!why.empty()) {
    Report report;
    report.kind = Report::Kind::finished;
    report.ticket = asked.ticket;
    report.state = CommandState::error;
    report.text = why;
    reports_.push_back(std::move(report));
    return true;
  }
  // All that is read is under the old offset, and all of it means the tip.
  interp_.replace_tool_offset(entry.offset);
  canon_.replace_tool_offset(entry.offset);
  history_.each([&](BlockRecord& r) {
    r.modal.frame.use_tool_length_offset(entry.offset);
    r.canon.frame.use_tool_length_offset(entry.offset);
    r.canon.position = r.canon.position + change;
    r.offset_before = entry.offset;
    r.low = r.low + change;
    r.high = r.high + change;
  });
  shift_ = shift_ + change;
  if (number != old_number) {
    exchange_order_ = p_.io.order(io::ToolOrder::Kind::set_number, number, epoch_);
  } else {
    const io::IoState io = p_.io.state();
    interp_.set_tool_in_spindle(io.tool_in_spindle, io.pocket_in_spindle);
  }
  ask_shift(asked.ticket);
  return true;
}

void InterpreterParticipant::ask_shift(Ticket ticket) {
  Report report;
  report.kind = Report::Kind::path_shift;
  report.ticket = ticket;
  report.epoch = epoch_;
  report.shift = shift_;
  reports_.push_back(std::move(report));
}

}  // namespace kerf::task
