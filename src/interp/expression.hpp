// The operations of expressions on plain numbers. The parser uses them for constants, the interpreter for all else.
#pragma once

#include "interp/block.hpp"

namespace kerf::interp {

[[nodiscard]] constexpr bool is_binary(Op op) noexcept { return op >= Op::power || op == Op::atan; }
/// Null, or why `a op b` cannot be computed.
[[nodiscard]] const char* refusal(Op op, double a, double b) noexcept;
/// `a op b` for what refusal() lets pass.
[[nodiscard]] double compute(Op op, double a, double b) noexcept;
/// Functions of one operand and the sign: null, or why `v` cannot be computed.
[[nodiscard]] const char* compute(Op op, double& v) noexcept;
/// The number of a parameter, 0 when `v` is none.
[[nodiscard]] int whole_index(double v) noexcept;

}  // namespace kerf::interp
