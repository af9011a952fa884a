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
#include <vector>

#include "interp/canon.hpp"

namespace kerf::interp {

/// `buffer.call<&Canon::straight_feed>(end)` remembers a call; deliver() makes all of them in order.
/// Memory is kept from block to block, so the plain path does not allocate.
class CanonBuffer {
 public:
  template <auto Method, class... Args>
  void call(const Args&... args) {
    Caller<Method>::store(calls_.emplace_back(), args...);
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

 private:
  static constexpr std::size_t kArguments = 120;
  struct Call {
    void (*play)(Canon&, const std::byte*);
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
