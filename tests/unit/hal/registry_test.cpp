#include "hal/core/registry.hpp"
#include "harness/no_tsan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "hal/core/value_text.hpp"
#include "hal/core/view.hpp"

namespace kerf::hal {
namespace {

using testing::HasSubstr;

class RegistryTest : public testing::Test {
 protected:
  RegistryTest() : registry_(std::move(Registry::create(*segment_)).value()) {
    comp_ = *registry_->add_component("c", ComponentKind::realtime);
    for (const char* name : {"f-in", "f-in2"}) pin(name, Type::floating, Dir::in);
    for (const char* name : {"f-out", "f-out2"}) pin(name, Type::floating, Dir::out);
    for (const char* name : {"f-io", "f-io2"}) pin(name, Type::floating, Dir::io);
    pin("b-in", Type::bit, Dir::in);
    pin("b-out", Type::bit, Dir::out);
  }
  ItemRecord* pin(std::string_view name, Type type, Dir dir, std::uint64_t initial = 0) {
    return *registry_->add_pin(*comp_, name, type, dir, initial);
  }
  std::string net(const char* signal, std::vector<std::string> pins) {
    const auto status = registry_->net(signal, pins);
    return status.ok() ? "" : status.error().message();
  }
  void write(const char* name, double v) {
    registry_->slot_ref(*registry_->find_pin(name)).slot().store(to_raw(v));
  }
  double read(const char* name) {
    return from_raw<double>(registry_->slot_ref(*registry_->find_pin(name)).slot().load());
  }
  std::unique_ptr<rtapi::Segment> segment_ = rtapi::Segment::in_memory();
  std::unique_ptr<Registry> registry_;
  ComponentRecord* comp_{nullptr};
};

TEST_F(RegistryTest, NamesAreUniqueOfAKindAndChecked) {
  EXPECT_THAT(registry_->add_pin(*comp_, "f-in", Type::bit, Dir::in, 0).error().message(),
              HasSubstr("duplicate pin 'f-in'"));
  EXPECT_TRUE(registry_->add_param(*comp_, "f-in", Type::bit, Dir::rw, 0).ok());
  EXPECT_THAT(registry_->add_component("c", ComponentKind::user).error().message(),
              HasSubstr("duplicate component 'c'"));
  EXPECT_FALSE(registry_->add_pin(*comp_, "has blank", Type::bit, Dir::in, 0).ok());
  EXPECT_FALSE(registry_->add_pin(*comp_, "", Type::bit, Dir::in, 0).ok());
  EXPECT_FALSE(registry_->add_pin(*comp_, std::string(56, 'x'), Type::bit, Dir::in, 0).ok());
  EXPECT_TRUE(registry_->add_pin(*comp_, std::string(55, 'x'), Type::bit, Dir::in, 0).ok());
}

TEST_F(RegistryTest, NetSharesOneSlotAndUnlinkKeepsTheValue) {
  EXPECT_EQ(net("s", {"f-out", "f-in", "f-in2"}), "");
  write("f-out", 2.5);
  EXPECT_EQ(read("f-in"), 2.5);
  EXPECT_TRUE(registry_->unlink("f-in").ok());
  write("f-out", 3.5);
  EXPECT_EQ(read("f-in"), 2.5);
  EXPECT_EQ(read("f-in2"), 3.5);
  EXPECT_TRUE(registry_->delete_signal("s").ok());
  EXPECT_EQ(read("f-out"), 3.5);
  EXPECT_EQ(read("f-in2"), 3.5);
  EXPECT_EQ(registry_->find_signal("s"), nullptr);
}

TEST_F(RegistryTest, TheFirstPinGivesTheSignalItsValue) {
  write("f-in", 7);
  write("f-in2", 9);
  EXPECT_TRUE(registry_->new_signal("s", Type::floating).ok());
  EXPECT_TRUE(registry_->set_signal("s", "5").ok());
  EXPECT_TRUE(registry_->link("f-in", "s").ok());
  EXPECT_EQ(read("f-in"), 7);
  EXPECT_TRUE(registry_->link("f-in2", "s").ok());
  EXPECT_EQ(read("f-in2"), 7);
}

TEST_F(RegistryTest, SecondWriterNamesBothPins) {
  EXPECT_EQ(net("s", {"f-out"}), "");
  EXPECT_EQ(net("s", {"f-out2"}),
            "Signal 's' can not add OUT pin 'f-out2', it already has OUT pin 'f-out'");
  EXPECT_EQ(net("t", {"f-out2", "f-out"}), "Pin 'f-out' was already linked to signal 's'");
  EXPECT_EQ(registry_->find_signal("t"), nullptr);
}

TEST_F(RegistryTest, BidirectionalPinsShareButNotWithAnOutput) {
  EXPECT_EQ(net("s", {"f-io", "f-io2", "f-in"}), "");
  EXPECT_EQ(net("s", {"f-out"}),
            "Signal 's' can not add OUT pin 'f-out', it already has I/O pin 'f-io2'");
  EXPECT_EQ(net("t", {"f-out"}), "");
  EXPECT_TRUE(registry_->unlink("f-io").ok());
  EXPECT_EQ(net("t", {"f-io"}),
            "Signal 't' can not add I/O pin 'f-io', it already has OUT pin 'f-out'");
  EXPECT_FALSE(registry_->link("f-io", "t").ok());
}

TEST_F(RegistryTest, TypeMismatchNamesBothTypes) {
  EXPECT_EQ(net("s", {"f-out"}), "");
  EXPECT_EQ(net("s", {"b-in"}), "Signal 's' of type 'float' cannot add pin 'b-in' of type 'bit'");
  EXPECT_EQ(net("t", {"b-out", "f-in"}),
            "Signal 't' of type 'bit' (from pin 'b-out') cannot add pin 'f-in' of type 'float'");
}

TEST_F(RegistryTest, NetDoesAllOrNothing) {
  for (const auto& pins : std::vector<std::vector<std::string>>{{"f-in", "f-in2", "nothere"},
                                                                {"f-in", "b-in"},
                                                                {"f-in", "f-out", "f-out2"},
                                                                {"f-io", "f-out"}}) {
    EXPECT_NE(net("s", pins), "");
    EXPECT_EQ(registry_->find_signal("s"), nullptr);
    for (const auto& name : {"f-in", "f-in2", "f-out", "f-out2", "b-in", "f-io"}) {
      EXPECT_EQ(registry_->find_pin(name)->signal.get(), 0U) << name;
    }
  }
  EXPECT_EQ(net("s", {"f-in"}), "");
  EXPECT_NE(net("s", {"f-in2", "b-in"}), "");
  EXPECT_EQ(registry_->find_pin("f-in2")->signal.get(), 0U);
  EXPECT_EQ(net("s", {"f-in", "f-in", "f-in2", "f-in2"}), "");
}

TEST_F(RegistryTest, NetMessagesSayWhatIsNear) {
  EXPECT_EQ(net("s", {"f-inn"}), "Pin 'f-inn' does not exist; did you mean 'f-in'?");
  EXPECT_EQ(net("f-in", {"f-in2"}),
            "Signal name 'f-in' must not be the same as a pin.  Did you omit the signal name?");
  EXPECT_EQ(net("s", {}), "'net' requires at least one pin, none given");
}

TEST_F(RegistryTest, SetpAndSetsKeepTheirRules) {
  (void)registry_->add_param(*comp_, "rw", Type::s32, Dir::rw, 0);
  (void)registry_->add_param(*comp_, "ro", Type::s32, Dir::ro, 0);
  EXPECT_TRUE(registry_->set_item("rw", "-12").ok());
  EXPECT_TRUE(registry_->set_item("f-in", "1e3").ok());
  EXPECT_TRUE(registry_->set_item("f-io", "1").ok());
  EXPECT_EQ(registry_->set_item("ro", "1").error().message(), "param 'ro' is not writable");
  EXPECT_EQ(registry_->set_item("f-out", "1").error().message(), "pin 'f-out' is not writable");
  EXPECT_EQ(registry_->set_item("rwx", "1").error().message(),
            "parameter or pin 'rwx' not found; did you mean 'rw'?");
  EXPECT_EQ(net("s", {"f-in", "f-out"}), "");
  EXPECT_THAT(registry_->set_item("f-in", "1").error().message(),
              HasSubstr("pin 'f-in' is connected to a signal"));
  EXPECT_THAT(registry_->set_signal("s", "1").error().message(),
              HasSubstr("signal 's' already has writer(s)"));
}

TEST_F(RegistryTest, RemovingAComponentUnlinksAndForgetsItsItems) {
  auto* other = *registry_->add_component("d", ComponentKind::user, 1);
  (void)registry_->add_pin(*other, "d.out", Type::floating, Dir::out, to_raw(4.0));
  EXPECT_EQ(net("s", {"d.out", "f-in"}), "");
  registry_->remove_component(*other);
  EXPECT_EQ(registry_->find_pin("d.out"), nullptr);
  EXPECT_EQ(registry_->find_signal("s")->writers, 0U);
  EXPECT_EQ(read("f-in"), 4.0);
  EXPECT_EQ(net("s", {"f-out"}), "");
}

TEST_F(RegistryTest, LoadingAndUnloadingDoesNotGrow) {
  std::uint64_t after_first = 0;
  std::uint64_t used = 0;
  for (int i = 0; i < 300; ++i) {
    auto* comp = *registry_->add_component("x", ComponentKind::realtime, 0, "count=3", true);
    for (int p = 0; p < 20; ++p) {
      (void)registry_->add_pin(*comp, "x." + std::to_string(p), Type::s32, Dir::out, 0);
    }
    EXPECT_EQ(net("sx", {"x.0"}), "");
    registry_->remove_component(*comp);
    EXPECT_TRUE(registry_->delete_signal("sx").ok());
    registry_->reclaim();
    if (i == 10) after_first = registry_->arena_bytes();
    if (i == 10) used = segment_->region(rtapi::Region::structure).used.get();
  }
  EXPECT_EQ(registry_->arena_bytes(), after_first);
  EXPECT_EQ(segment_->region(rtapi::Region::structure).used.get(), used);
}

TEST_F(RegistryTest, MemoryWaitsForTheThreadsCycle) {
  auto* thread = *registry_->add_thread(*comp_, "t", 1'000'000);
  thread->ticking.publish(1);
  auto* victim = *registry_->add_component("x", ComponentKind::realtime);
  const auto first = (*registry_->add_pin(*victim, "x.p", Type::s32, Dir::out, 0))->link;
  registry_->remove_component(*victim);
  const auto add = [&](const char* name) {
    return (*registry_->add_pin(*comp_, name, Type::s32, Dir::out, 0))->link;
  };
  EXPECT_NE(add("new-1"), first);
  EXPECT_NE(add("new-2"), first);
  thread->cycles.publish(thread->cycles.get() + 1);
  EXPECT_EQ(add("new-3"), first);
}

TEST_F(RegistryTest, ASignalSeenByAUserComponentWaitsForItsEnd) {
  auto* user = *registry_->add_component("u", ComponentKind::user, 1);
  (void)registry_->add_pin(*user, "u.in", Type::floating, Dir::in, 0);
  EXPECT_EQ(net("s", {"f-out", "u.in"}), "");
  const auto place = [&](const char* name) { return registry_->find_signal(name)->value; };
  const rtapi::Offset slot = place("s");
  EXPECT_TRUE(registry_->delete_signal("s").ok());
  for (const char* name : {"s1", "s2", "s3"}) {
    EXPECT_TRUE(registry_->new_signal(name, Type::floating).ok());
    EXPECT_NE(place(name), slot) << name;
  }
  registry_->remove_component(*user);
  EXPECT_TRUE(registry_->new_signal("s4", Type::floating).ok());
  EXPECT_EQ(place("s4"), slot);
}

TEST(Registry, AFullSegmentIsAnErrorThatNamesTheKey) {
  auto segment = rtapi::Segment::in_memory(4U << 20U);
  auto registry = std::move(Registry::create(*segment)).value();
  auto* comp = *registry->add_component("c", ComponentKind::realtime);
  std::string message;
  for (int i = 0; i < 40'000 && message.empty(); ++i) {
    auto pin = registry->add_pin(*comp, "p." + std::to_string(i), Type::bit, Dir::in, 0);
    if (!pin.ok()) message = pin.error().message();
  }
  EXPECT_THAT(message, HasSubstr("[KERF]SEGMENT_MB"));
  EXPECT_NE(registry->find_pin("p.0"), nullptr);
}

TEST(View, SeesWholeStatesWhileAnotherProcessChanges) {
  KERF_NOT_UNDER_TSAN();
  const std::string instance = "test-view-" + std::to_string(::getpid());
  auto segment = std::move(rtapi::Segment::create(instance)).value();
  auto registry = std::move(Registry::create(*segment)).value();
  auto* fixed = *registry->add_component("fixed", ComponentKind::realtime);
  (void)registry->add_pin(*fixed, "fixed.a", Type::bit, Dir::out, 1);
  const pid_t child = ::fork();
  if (child == 0) {
    for (int i = 0; i < 20'000; ++i) {
      auto made = registry->add_component("moving", ComponentKind::realtime);
      if (!made.ok()) ::_exit(1);
      (void)registry->add_pin(**made, "moving.a", Type::bit, Dir::in, 0);
      (void)registry->add_pin(**made, "moving.b", Type::bit, Dir::in, 0);
      const std::string pins[] = {"moving.a", "moving.b"};
      (void)registry->net("s", pins);
      registry->remove_component(**made);
      (void)registry->delete_signal("s");
    }
    ::_exit(0);
  }
  const View view(*segment);
  int status = 0;
  int looks = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    ++looks;
    ASSERT_TRUE(view.find_pin("fixed.a").has_value());
    const auto pins = view.pins();
    ASSERT_GE(pins.size(), 1U);
    ASSERT_LE(pins.size(), 3U);
    ASSERT_EQ(pins[0].name, "fixed.a");
    ASSERT_EQ(pins[0].owner, "fixed");
    const auto signal = view.find_signal("s");
    if (signal) {
      ASSERT_TRUE(signal->pins.empty() || signal->pins.size() == 2U) << signal->pins.size();
    }
  }
  EXPECT_EQ(status, 0);
  EXPECT_GT(looks, 0);
  EXPECT_FALSE(view.stuck());
  registry.reset();
  segment.reset();
  (void)rtapi::Segment::remove(instance);
}

TEST(ValueText, ReadsAndPrintsAsHalcmd) {
  const auto raw = [](Type t, const char* s) {
    auto v = parse_value(t, s);
    return v.ok() ? plain_value_text(t, *v) : "error: " + v.error().message();
  };
  EXPECT_EQ(raw(Type::bit, "1"), "TRUE");
  EXPECT_EQ(raw(Type::bit, "tRuE"), "TRUE");
  EXPECT_EQ(raw(Type::bit, "FALSE"), "FALSE");
  for (const char* bad : {"2", "yes", "00", ""}) {
    EXPECT_EQ(raw(Type::bit, bad), "error: value '" + std::string(bad) + "' invalid for bit");
  }
  EXPECT_EQ(raw(Type::floating, "1.23456789012"), "1.234568");
  EXPECT_EQ(raw(Type::floating, "0x10"), "16");
  EXPECT_EQ(raw(Type::floating, "1,5"), "error: value '1,5' invalid for float");
  EXPECT_EQ(raw(Type::s32, "-5"), "-5");
  EXPECT_EQ(raw(Type::s32, "0x10"), "16");
  EXPECT_EQ(raw(Type::s32, "0xFFFFFFFF"), "-1");
  EXPECT_EQ(raw(Type::s32, "2147483647"), "2147483647");
  EXPECT_EQ(raw(Type::s32, "2147483648"),
            "error: value '2147483648' invalid for S32 (out of range)");
  EXPECT_EQ(raw(Type::s32, "1.5"), "error: value '1.5' invalid for S32");
  EXPECT_EQ(raw(Type::u32, "-1"), "4294967295");
  EXPECT_EQ(raw(Type::u32, "010"), "8");
  EXPECT_EQ(raw(Type::u32, "4294967296"),
            "error: value '4294967296' invalid for U32 (out of range)");
  EXPECT_EQ(raw(Type::s64, "-9223372036854775808"), "-9223372036854775808");
  EXPECT_EQ(raw(Type::s64, "0xFFFFFFFFFFFFFFFF"), "-1");
  EXPECT_EQ(raw(Type::s64, "9223372036854775807"), "9223372036854775807");
  EXPECT_EQ(raw(Type::s64, "9223372036854775808"),
            "error: value '9223372036854775808' invalid for S64 (out of range)");
  EXPECT_EQ(raw(Type::s64, "-9223372036854775809"),
            "error: value '-9223372036854775809' invalid for S64 (out of range)");
  for (const char* bad : {"0b101", "08", "5u", "1e3", " 5", "5 ", "", "-", "0x"}) {
    for (const Type type : {Type::s32, Type::u32, Type::s64, Type::u64, Type::port})
      EXPECT_THAT(raw(type, bad), HasSubstr("value '" + std::string(bad) + "' invalid for")) << bad;
  }
  EXPECT_EQ(raw(Type::port, "4096"), "4096");
  EXPECT_EQ(raw(Type::floating, "1e400"), "inf");
  EXPECT_EQ(raw(Type::floating, "nan"), "nan");
  EXPECT_EQ(value_text(Type::s64, to_raw(std::int64_t{-5})), "-5");
  EXPECT_EQ(raw(Type::u64, "-1"), "18446744073709551615");
  EXPECT_EQ(raw(Type::u64, "18446744073709551615"), "18446744073709551615");
  EXPECT_EQ(raw(Type::u64, "18446744073709551616"),
            "error: value '18446744073709551616' invalid for U64 (out of range)");
  EXPECT_EQ(value_text(Type::u32, 255), "0x000000FF");
  EXPECT_EQ(value_text(Type::u64, 255), "0x00000000000000FF");
}

}  // namespace
}  // namespace kerf::hal
