// Expressions: runs the postfix programs that the parser made. Manual: "Expressions", "Functions".
#include <cmath>

#include "interp/core.hpp"
#include "interp/expression.hpp"
#include "rtapi/base/suggest.hpp"

namespace kerf::interp {

namespace {

/// #5420 to #5428.
constexpr bool is_position(int index) { return index >= kPosition && index <= kPositionLast; }
/// Angles are computed as exactly as the peer does, so that SIN[30] is 0.5 and FIX[2 * SIN[30]] is 1.
constexpr long double kPi = 3.141592653589793238462643383279502884L;
double degrees(double radians) { return static_cast<double>(radians * 180 / kPi); }
long double radians(double degrees) { return degrees * kPi / 180; }
/// Brackets are limited by the parser; each can hold back one operand per level of precedence.
constexpr int kStack = 512;

double truth(bool b) { return b ? 1.0 : 0.0; }

}  // namespace

const char* refusal(Op op, double a, double b) noexcept {
  if (op == Op::divide && b == 0) return "Attempt to divide by zero";
  if (op == Op::power && a < 0 && b != std::floor(b))
    return "Attempt to raise negative to non integer power";
  return nullptr;
}

double compute(Op op, double a, double b) noexcept {
  switch (op) {
    case Op::atan: return degrees(std::atan2(a, b));
    case Op::power: return std::pow(a, b);
    case Op::times: return a * b;
    case Op::divide: return a / b;
    case Op::modulo: {
      const double r = std::fmod(a, b);
      return r < 0 ? r + std::fabs(b) : r;
    }
    case Op::plus: return a + b;
    case Op::minus: return a - b;
    case Op::eq: return truth(std::fabs(a - b) < kTolerance);
    case Op::ne: return truth(!(std::fabs(a - b) < kTolerance));
    case Op::gt: return truth(a > b);
    case Op::ge: return truth(a >= b);
    case Op::lt: return truth(a < b);
    case Op::le: return truth(a <= b);
    case Op::op_and: return truth(a != 0 && b != 0);
    case Op::op_or: return truth(a != 0 || b != 0);
    case Op::op_xor: return truth((a != 0) != (b != 0));
    default: return 0;
  }
}

const char* compute(Op op, double& v) noexcept {
  switch (op) {
    case Op::negate: v = -v; break;
    case Op::abs: v = std::fabs(v); break;
    case Op::acos:
      if (v < -1 || v > 1) return "Argument to acos out of range";
      v = degrees(std::acos(v));
      break;
    case Op::asin:
      if (v < -1 || v > 1) return "Argument to asin out of range";
      v = degrees(std::asin(v));
      break;
    case Op::cos: v = static_cast<double>(std::cos(radians(v))); break;
    case Op::exp: v = std::exp(v); break;
    case Op::fix: v = std::floor(v); break;
    case Op::fup: v = std::ceil(v); break;
    case Op::ln:
      if (v <= 0) return "Zero or negative argument to ln";
      v = std::log(v);
      break;
    case Op::round: v = std::floor(std::fabs(v) + 0.5) * (v < 0 ? -1 : 1); break;
    case Op::sin: v = static_cast<double>(std::sin(radians(v))); break;
    case Op::sqrt:
      if (v < 0) return "Negative argument to sqrt";
      v = std::sqrt(v);
      break;
    case Op::tan: v = static_cast<double>(std::tan(radians(v))); break;
    default: break;
  }
  return nullptr;
}

int whole_index(double v) noexcept {
  const double index = std::nearbyint(v);
  return std::fabs(v - index) <= kTolerance && index >= 1 && index < kParameterCount
             ? static_cast<int>(index)
             : 0;
}

double Core::parameter(int index) const {
  if (index < kToolNumber || index > kPositionLast) return params.get(index);
  if (index == kToolNumber) return spindle_tool.number < 0 ? 0 : spindle_tool.number;
  if (index <= kToolNumber + 9) {
    const auto axis = static_cast<std::size_t>(index - kToolNumber - 1);
    return rtapi::is_rotary(axis) ? spindle_tool.offset[axis]
                                  : spindle_tool.offset[axis] / settings.machine_unit_mm;
  }
  if (index == 5410) return spindle_tool.diameter_mm / settings.machine_unit_mm;
  if (index == 5411) return spindle_tool.front_angle_deg;
  if (index == 5412) return spindle_tool.back_angle_deg;
  if (index == kToolLast) return spindle_tool.orientation;
  if (index >= kPosition) {
    const auto axis = static_cast<std::size_t>(index - kPosition);
    const double v = shown_position()[axis];
    return rtapi::is_rotary(axis) ? v : in_units(v, state.unit_mm());
  }
  return params.get(index);
}

bool Core::read_named(std::uint32_t id, Value& value, bool& exists) {
  exists = true;
  if (const Value* v = params.find(id); v != nullptr) {
    value = *v;
    return true;
  }
  if (params.is_global(id)) {
    const std::string& name = params.name(id);
    if (attached_ && script_parameter(name, value)) return true;
    if (const Predefined::Getter get = predefined_.by_id(id, name); get != nullptr) {
      value = {get(*this), nullptr};
      return true;
    }
    std::optional<double> outside;
    if (name.starts_with("_hal[") && name.back() == ']' && settings.hal_pin_vars) {
      outside = env.hal_value(std::string_view(name).substr(5, name.size() - 6));
    } else if (name.starts_with("_ini[") && settings.ini_vars) {
      std::string upper(name.substr(5));
      for (char& c : upper) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c;
      const std::size_t end = upper.find(']');
      if (end != std::string::npos)
        outside = env.ini_value(std::string_view(upper).substr(0, end),
                                std::string_view(upper).substr(end + 1));
    }
    if (outside) {
      value = {*outside, nullptr};
      return true;
    }
  }
  exists = false;
  return false;
}

bool Core::undefined_name(std::uint32_t id, std::size_t at) {
  const std::string& name = params.name(id);
  std::vector<std::string_view> known = params.visible_names();
  Predefined::add_names(known);
  const std::string near = rtapi::nearest_name(name, known);
  const std::string help = "Assign it first, or test it with EXISTS" +
                           (near.empty() ? "" : "; did you mean #<" + near + ">?");
  return fail_at(at, help.c_str(), "Named parameter #<%s> not defined", name.c_str());
}

bool Core::position_unknown(std::size_t at) {
  return fail_at(at, "#<_x> to #<_w> tell where the tool is going to stand",
                 "Cannot read current position with cutter radius compensation on");
}

bool Core::no_number(std::size_t at, double value) {
  return fail_at(at, "The values lead to no number that can be used",
                 "Calculation resulted in '%s'", std::isnan(value) ? "not a number" : "infinity");
}

bool Core::evaluate(const ParsedBlock& b, const Expr& e, double& value) {
  double stack[kStack];
  double* top = stack;  // the last operand; the first place stays empty
  const ExprOp* op = b.ops.data() + e.first;
  for (const ExprOp* const end = op + e.count; op != end; ++op) {
    if (top >= stack + kStack - 1) return fail_at(op->at, "", "Expression nested too deeply");
    switch (op->op) {
      case Op::number: *++top = op->value; continue;
      case Op::parameter_at: {
        const int index = static_cast<int>(op->id);
        if (is_position(index) && state.cutter_comp != 400) return position_unknown(op->at);
        *++top = parameter(index);
        continue;
      }
      case Op::parameter: {
        const int index = whole_index(*top);
        if (index > 0) {
          if (is_position(index) && state.cutter_comp != 400) return position_unknown(op->at);
          *top = parameter(index);
          continue;
        }
        if (std::fabs(*top - std::nearbyint(*top)) > kTolerance)
          return fail_at(op->at, "", "Non integer value for integer");
        return fail_at(op->at, "Numbers go from 1 to 5602", "Parameter number out of range");
      }
      case Op::named: {
        if (const Value* const known = params.find(op->id); known != nullptr) {
          *++top = known->number;
          continue;
        }
        Value v;
        bool exists = false;
        if (!read_named(op->id, v, exists)) return undefined_name(op->id, op->at);
        *++top = v.number;
        continue;
      }
      case Op::exists_named: {
        Value v;
        bool exists = false;
        (void)read_named(op->id, v, exists);
        *++top = truth(exists);
        continue;
      }
      case Op::external:
        if (!dialect.functions[op->id].run(*this, *top)) return false;
        continue;
      case Op::exists_numbered:  // as the peer: every number that can be written exists
        *top = truth(*top >= 1 && *top < kParameterCount);
        continue;
      case Op::plus:
        --top;
        *top += top[1];
        continue;
      case Op::minus:
        --top;
        *top -= top[1];
        continue;
      case Op::times:
        --top;
        *top *= top[1];
        continue;
      default: break;
    }
    if (is_binary(op->op)) {
      --top;
      if (const char* why = refusal(op->op, *top, top[1]); why != nullptr)
        return fail_at(op->at, "", "%s", why);
      *top = compute(op->op, *top, top[1]);
    } else if (const char* why = compute(op->op, *top); why != nullptr) {
      return fail_at(op->at, "", "%s", why);
    }
    // Here already: a comparison would make a number of it again.
    if (!std::isfinite(*top)) return no_number(op->at, *top);
  }
  value = top > stack ? *top : 0;
  return std::isfinite(value) || no_number(b.ops[e.first].at, value);
}

}  // namespace kerf::interp
