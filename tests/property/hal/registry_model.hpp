// Model: what HAL ought to be, in plain maps, for the property test of Registry.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "hal/core/registry.hpp"

namespace kerf::hal::test {

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  int integer(int from, int to) { return std::uniform_int_distribution<int>(from, to)(engine_); }
  bool chance(double p) { return std::uniform_real_distribution<double>(0, 1)(engine_) < p; }
  template <class C>
  auto& pick(C& from) {
    auto it = from.begin();
    std::advance(it, integer(0, static_cast<int>(from.size()) - 1));
    return *it;
  }

 private:
  std::mt19937 engine_;
};

struct ModelItem {
  Kind kind{Kind::pin};
  Type type{Type::unspecified};
  Dir dir{Dir::unspecified};
  std::string original;
  std::string alias;  ///< empty: none
  std::string component;
  std::string signal;
  std::uint64_t value{0};
  std::uint64_t* cell{nullptr};
  bool native{false};
  [[nodiscard]] const std::string& shown() const { return alias.empty() ? original : alias; }
};

struct ModelSignal {
  Type type{Type::unspecified};
  std::set<std::string> pins;  ///< original names
  std::uint64_t value{0};
  bool seen{false};
};

struct ModelComponent {
  bool user{false};
  bool ready{false};
  std::uint64_t holder{0};  ///< number in Model::holders, of a user component
};

struct ModelThread {
  std::string component;
  std::uint64_t number{0};
  std::uint64_t cycles{0};
  bool ticking{false};
  std::vector<std::string> functions;
};

/// Memory that somebody may still use.
struct Forbidden {
  Offset offset;
  std::size_t bytes;
  std::set<std::uint64_t> holders;
  std::map<std::uint64_t, std::uint64_t> cycles;  ///< by the number of the thread
  std::string what;
};

struct Model {
  std::map<std::string, ModelComponent> components;
  std::map<std::string, ModelItem> items[2];  ///< pins and parameters, by original name
  std::map<std::string, ModelSignal> signals;
  std::map<std::string, std::string> functions;  ///< to component
  std::map<std::string, ModelThread> threads;
  std::map<std::string, std::size_t> memories;
  std::map<std::uint64_t, bool> holders;  ///< true: of everything
  std::uint64_t next_holder{1};
  std::vector<Forbidden> forbidden;

  static int index(Kind kind) { return kind == Kind::pin ? 0 : 1; }
  ModelItem* find(Kind kind, const std::string& name) {
    for (auto& [original, item] : items[index(kind)])
      if (original == name || item.alias == name) return &item;
    return nullptr;
  }
  ModelItem* pin(const std::string& name) { return find(Kind::pin, name); }
  [[nodiscard]] int count(const ModelSignal& signal, Dir dir) {
    return static_cast<int>(std::count_if(signal.pins.begin(), signal.pins.end(),
                                          [&](auto& p) { return items[0].at(p).dir == dir; }));
  }
  bool is_user(const ModelItem& item) { return components.at(item.component).user; }

  /// Whether one more pin may be linked to what has so many writers.
  static bool fits(Dir dir, int outs, int ios) {
    if (dir == Dir::in) return true;
    return outs == 0 && (dir == Dir::io || ios == 0);
  }
  void attach(ModelItem& pin, const std::string& name) {
    ModelSignal& signal = signals[name];
    if (signal.pins.empty() && pin.type != Type::port) signal.value = pin.value;
    signal.pins.insert(pin.original);
    pin.signal = name;
    if (is_user(pin)) signal.seen = true;
  }
  void detach(ModelItem& pin) {
    if (pin.signal.empty()) return;
    ModelSignal& signal = signals.at(pin.signal);
    pin.value = pin.type == Type::port ? 0 : signal.value;
    signal.pins.erase(pin.original);
    pin.signal.clear();
  }
  std::uint64_t& value_of(ModelItem& item) {
    return item.signal.empty() ? item.value : signals.at(item.signal).value;
  }

  /// Nobody may get this memory before those who are here now have gone, and each ticking thread has ended a cycle.
  void forbid(std::string what, Offset offset, std::size_t bytes, bool by_holders,
              bool by_curious = true) {
    Forbidden f{offset, bytes, {}, {}, std::move(what)};
    for (const auto& [holder, everything] : holders)
      if (by_holders || (by_curious && everything)) f.holders.insert(holder);
    for (const auto& [name, thread] : threads)
      if (thread.ticking) f.cycles[thread.number] = thread.cycles;
    forbidden.push_back(std::move(f));
  }
  [[nodiscard]] bool over(const Forbidden& f) {
    for (const auto holder : f.holders)
      if (holders.count(holder) > 0) return false;
    for (const auto& [name, thread] : threads) {
      const auto it = f.cycles.find(thread.number);
      if (it != f.cycles.end() && thread.ticking && thread.cycles == it->second) return false;
    }
    return true;
  }
  /// Empty, or whose memory it is that was given out too early.
  std::string given(Offset offset, std::size_t bytes) {
    std::erase_if(forbidden, [&](const Forbidden& f) { return over(f); });
    for (const auto& f : forbidden)
      if (offset < f.offset + f.bytes && f.offset < offset + bytes) return f.what;
    return {};
  }
};

}  // namespace kerf::hal::test
