// Components for the tests of the loader. Each records what it does in pins only.
#pragma once

#include <functional>

#include "hal/component.hpp"
#include "harness/module_of.hpp"

namespace kerf::hal::test {

/// out = in + step, once a cycle; personality gives the number of extra inputs.
class Adder final : public Component<Adder> {
 public:
  static constexpr Info kInfo{.name = "adder", .summary = "in + step"};
  using Component::Component;

 private:
  In<std::int32_t> in_{pin<In<std::int32_t>>("in", "Input")};
  Param<std::int32_t> step_{param<Param<std::int32_t>>("step", "Added", 1)};
  Out<std::int32_t> out_{pin<Out<std::int32_t>>("out", "Sum")};
  PinArray<In<bool>, 8> extra_{
      pins<In<bool>, 8>("x-##", static_cast<std::size_t>(personality()), "Extra ##")};
  void update(const Period&) noexcept { out_ = in_ + step_; }
  Function update_{function<&Adder::update>("", "Recompute out")};
};

/// Makes up to four threads, as the `threads` component does.
class TestThreads final : public Component<TestThreads> {
 public:
  static constexpr Info kInfo{.name = "test-threads", .summary = "Threads", .singleton = true};
  explicit TestThreads(Builder& b) noexcept : Component(b) {
    for (const char* n : {"1", "2", "3", "4"}) {
      char name[8] = "name";
      char period[8] = "period";
      name[4] = n[0];
      period[6] = n[0];
      const auto text = text_arg(name, "", "Name");
      const auto ns = int_arg(period, 0, "Period [ns]");
      if (!text.empty()) b.add_thread(text, ns);
    }
  }
};

/// Has a thread and a function, as motmod does.
class AdderThread final : public Component<AdderThread> {
 public:
  static constexpr Info kInfo{.name = "adder-thread", .summary = "Both", .singleton = true};
  explicit AdderThread(Builder& b) noexcept : Component(b) { b.add_thread("own", 8'000'000); }

 private:
  void update(const Period&) noexcept {}
  Function update_{function<&AdderThread::update>("", "Nothing")};
};

/// Offers a number to others.
class Provider final : public Component<Provider> {
 public:
  static constexpr Info kInfo{.name = "provider", .summary = "Offers", .singleton = true};
  explicit Provider(Builder& b) noexcept : Component(b) { b.provide("number", &number_); }

 private:
  int number_{42};
};
class Consumer final : public Component<Consumer> {
 public:
  static constexpr Info kInfo{.name = "consumer", .summary = "Uses", .singleton = true};
  explicit Consumer(Builder& b) noexcept : Component(b) {
    const auto* number = static_cast<const int*>(b.find_service("number"));
    if (number == nullptr) {
      b.fail("no number: load provider first");
      return;
    }
    value_.declare(b, b.full_name("value"), "The number", *number);
  }

 private:
  Out<std::int32_t> value_;
};

/// Fails in the second instance, after having exported things.
class Faulty final : public Component<Faulty> {
 public:
  static constexpr Info kInfo{.name = "faulty", .summary = "Fails", .default_count = 2};
  explicit Faulty(Builder& b) noexcept : Component(b) {
    declare_pin<In<bool>>(builder(), builder().full_name("in"), "Input");
    (void)b.shared_block("faulty", 64, 1);  // the second instance cannot have it
  }
  void update(const Period&) noexcept {}
  Function update_{function<&Faulty::update>("", "Nothing")};
};

/// Makes a block, and calls `while_made` before it is done with it, as another process might come by just then.
class BlockMaker final : public Component<BlockMaker> {
 public:
  static constexpr Info kInfo{.name = "block-maker", .summary = "Has a block", .singleton = true};
  static inline std::function<void()> while_made;
  explicit BlockMaker(Builder& b) noexcept : Component(b) {
    (void)b.shared_block("half-made", 64, 1);
    if (while_made) while_made();
  }
};

}  // namespace kerf::hal::test
