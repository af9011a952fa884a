// What flow.cpp and flow_words.cpp share.
#pragma once

#include "interp/program.hpp"

namespace kerf::interp {

inline constexpr FlowMask kEndIf = flow_bit(Flow::endif);
inline constexpr FlowMask kNextBranch =
    flow_bit(Flow::elseif) | flow_bit(Flow::else_block) | kEndIf;
inline constexpr FlowMask kSubBegins = flow_bit(Flow::sub) | flow_bit(Flow::program_number);
/// What is looked at per execute_next() while searching.
inline constexpr int kSkipLines = 1000;
inline constexpr std::uint64_t kSkipBytes = 65536;
inline constexpr const char* kNoEnd = "File ended with no percent sign (%) or program end (M2)";

/// The innermost loop of that label in the frame, null without.
[[nodiscard]] inline Loop* find_loop(Flows& flows, Label label) {
  for (std::size_t i = flows.loops.size(); i-- > flows.frames.back().first_loop;) {
    if (flows.loops[i].label == label) return &flows.loops[i];
  }
  return nullptr;
}

}  // namespace kerf::interp
