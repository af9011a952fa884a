// CanonBuffer: the canonical calls of one block, held back until the block is known to be good.
#pragma once

#include <cstddef>
#include <cstring>
#include <deque>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "interp/canon.hpp"

namespace kerf::interp {

/// Calls that overtake a move whose end is still open (cutter compensation): texts for the operator and what concerns no motion.
template <auto Method>
inline constexpr bool kOvertakes = false;
template <>
inline constexpr bool kOvertakes<&Canon::message> = true;
template <>
inline constexpr bool kOvertakes<&Canon::print> = true;
template <>
inline constexpr bool kOvertakes<&Canon::log_open> = true;
template <>
inline constexpr bool kOvertakes<&Canon::log> = true;
template <>
inline constexpr bool kOvertakes<&Canon::log_close> = true;
template <>
inline constexpr bool kOvertakes<&Canon::use_length_units> = true;
template <>
inline constexpr bool kOvertakes<&Canon::select_plane> = true;
template <>
inline constexpr bool kOvertakes<&Canon::select_tool> = true;
template <>
inline constexpr bool kOvertakes<&Canon::change_tool_number> = true;
template <>
inline constexpr bool kOvertakes<&Canon::set_tool_table_entry> = true;
template <>
inline constexpr bool kOvertakes<&Canon::reload_tooldata> = true;

/// `buffer.call<&Canon::straight_feed>(end)` remembers a call; deliver() makes all of them in order.
/// Memory is kept from block to block, so the plain path does not allocate.
class CanonBuffer {
 public:
  template <auto Method, class... Args>
  void call(const Args&... args) {
    Caller<Method>::store(calls_.emplace_back(), args...);
  }
  /// The same for a call that overtakes only here.
  template <auto Method, class... Args>
  void call_at_once(const Args&... args) {
    call<Method>(args...);
    calls_.back().overtakes = true;
  }
  /// A copy of `text` that lives until clear(): what text arguments of call() must point to.
  [[nodiscard]] std::string_view keep(std::string_view text) {
    if (texts_used_ == texts_.size()) texts_.emplace_back();
    std::string& slot = texts_[texts_used_++];
    slot.assign(text);
    return slot;
  }
  /// The same for control points.
  [[nodiscard]] std::span<const SplinePoint> keep(std::span<const SplinePoint> points) {
    points_.emplace_back(points.begin(), points.end());
    return points_.back();
  }
  [[nodiscard]] bool empty() const noexcept { return calls_.empty(); }
  [[nodiscard]] std::size_t size() const noexcept { return calls_.size(); }
  void clear() noexcept {
    calls_.clear();
    texts_used_ = 0;
    if (!points_.empty()) points_.clear();
  }
  /// Announces the source line, makes the calls, forgets them.
  void deliver(Canon& canon, const SourceLine& source) {
    if (!calls_.empty()) {
      canon.next_block(source);
      for (const Call& c : calls_) c.play(canon, c.data);
    }
    clear();
  }
  /// Which calls of a range are meant.
  enum class Which { all, overtaking, waiting };
  /// Makes the calls [from, to) without forgetting them. `announced`: the source line is.
  void play(Canon& canon, const SourceLine& source, std::size_t from, std::size_t to, Which which,
            bool& announced) const {
    for (std::size_t i = from; i < to; ++i) {
      const Call& c = calls_[i];
      if (which != Which::all && c.overtakes != (which == Which::overtaking)) continue;
      if (!announced) canon.next_block(source);
      announced = true;
      c.play(canon, c.data);
    }
  }
  void swap(CanonBuffer& other) noexcept {
    calls_.swap(other.calls_);
    texts_.swap(other.texts_);
    std::swap(texts_used_, other.texts_used_);
  }

 private:
  static constexpr std::size_t kArguments = 112;
  struct Call {
    void (*play)(Canon&, const std::byte*);
    bool overtakes{false};
    alignas(8) std::byte data[kArguments];
    Call() noexcept : play(nullptr) {}  // the bytes are written by store()
  };
  template <auto Method>
  struct Caller;
  template <class... P, void (Canon::*Method)(P...)>
  struct Caller<Method> {
    using Tuple = std::tuple<std::decay_t<P>...>;
    static_assert(sizeof(Tuple) <= kArguments && std::is_trivially_destructible_v<Tuple>);
    template <class... Args>
    static void store(Call& call, const Args&... args) {
      ::new (static_cast<void*>(call.data)) Tuple(args...);
      call.overtakes = kOvertakes<Method>;
      call.play = [](Canon& canon, const std::byte* data) {
        std::apply([&canon](const auto&... a) { (canon.*Method)(a...); },
                   *std::launder(reinterpret_cast<const Tuple*>(data)));
      };
    }
  };

  std::vector<Call> calls_;
  std::deque<std::string> texts_;
  std::size_t texts_used_{0};
  std::deque<std::vector<SplinePoint>> points_;
};

}  // namespace kerf::interp
