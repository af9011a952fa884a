// A host in private memory with the test components.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "hal/core/test_builder.hpp"
#include "hal/core/value_text.hpp"
#include "hal/core/view.hpp"
#include "hal/loader/host.hpp"
#include "unit/hal/test_components.hpp"

namespace kerf::hal::test {

inline std::span<const StaticModule> test_modules() {
  static const Module adder = module_of<Adder>();
  static const Module threads = module_of<TestThreads>();
  static const Module provider = module_of<Provider>();
  static const Module consumer = module_of<Consumer>();
  static const Module faulty = module_of<Faulty>();
  static const Module adder_thread = module_of<AdderThread>();
  static const Module block_maker = module_of<BlockMaker>();
  static const StaticModule table[] = {{"adder", &adder},
                                       {"test_threads", &threads},
                                       {"provider", &provider},
                                       {"consumer", &consumer},
                                       {"faulty", &faulty},
                                       {"adder_thread", &adder_thread},
                                       {"block_maker", &block_maker}};
  return table;
}

class HostTest : public testing::Test {
 protected:
  HostTest() {
    auto made = Host::create(*segment_, clock_, modules_);
    host_ = std::move(made).value();
    view_ = std::make_unique<View>(*segment_);
  }
  Reply command(std::initializer_list<std::string> argv) { return host_->command(argv); }
  /// The command must work.
  void ok(std::initializer_list<std::string> argv) {
    const Reply reply = host_->command(argv);
    EXPECT_TRUE(reply.ok()) << *argv.begin() << ": " << reply.text;
  }
  /// The command must be refused; gives the reason.
  std::string refused(std::initializer_list<std::string> argv) {
    const Reply reply = host_->command(argv);
    EXPECT_FALSE(reply.ok()) << *argv.begin();
    return reply.text;
  }
  void cycle(std::size_t thread = 0) {
    auto* runner = host_->threads().at(thread);
    clock_.advance(runner->period_ns());
    runner->run_cycle(clock_.now(), clock_.now());
  }
  [[nodiscard]] std::string value(const std::string& name) const {
    auto v = view_->value(name);
    return v.ok() ? *v : v.error().message();
  }

  std::unique_ptr<rtapi::Segment> segment_ = rtapi::Segment::in_memory();
  ManualClock clock_;
  StaticSource modules_{test_modules()};
  std::unique_ptr<Host> host_;
  std::unique_ptr<View> view_;
};

}  // namespace kerf::hal::test
