// loadrt parameters of motmod.
#pragma once

#include <cstdint>
#include <string_view>

#include "hal/component.hpp"
#include "motion/api/limits.hpp"

namespace kerf::motion {

struct MotmodArgs {
  std::int64_t base_period_ns{0}, servo_period_ns{1'000'000};
  std::int32_t joints{0}, extra_joints{0}, spindles{1}, dio{4}, aio{4}, misc_errors{0};
  std::uint32_t unlock_mask{0};
  std::string_view names_din, names_dout, names_ain, names_aout, names_misc;
};

/// Reads and checks them. After an error the builder has failed, and the values are within their ranges.
MotmodArgs read_args(hal::Builder& b) noexcept;

/// The next name of a list "a,b,c", taken off its front; "" at the end.
std::string_view take_name(std::string_view& list) noexcept;
std::size_t count_names(std::string_view list) noexcept;

}  // namespace kerf::motion
