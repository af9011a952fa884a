// Registry: aliases, queues of ports, memory, and who still holds what.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <thread>

#include "hal/core/port.hpp"
#include "hal/core/registry.hpp"
#include "hal/core/value_access.hpp"
#include "hal/core/value_text.hpp"
#include "hal/core/view.hpp"

namespace kerf::hal {
namespace {

using rtapi::Region;
using testing::ElementsAre;
using testing::HasSubstr;

class MemoryTest : public testing::Test {
 protected:
  MemoryTest() : registry_(std::move(Registry::create(*segment_)).value()) {
    comp_ = *registry_->add_component("c", ComponentKind::realtime);
  }
  ~MemoryTest() override {
    const auto good = registry_->check_invariants();
    EXPECT_TRUE(good.ok()) << good.error().message();
  }
  ItemRecord* pin(std::string_view name, Type type, Dir dir, std::uint64_t initial = 0) {
    return *registry_->add_pin(*comp_, name, type, dir, initial);
  }
  std::string net(const char* signal, std::vector<std::string> pins) {
    return said(registry_->net(signal, pins));
  }
  static std::string said(const rtapi::Status& status) {
    return status.ok() ? "" : status.error().message();
  }
  Port port(const char* pin) {
    const auto raw = registry_->slot_ref(*registry_->find_pin(pin)).slot().load();
    return {segment_->base(), static_cast<std::uint32_t>(raw)};
  }
  [[nodiscard]] std::string text(const char* name) const {
    auto value = View(*segment_).value(name);
    return value.ok() ? *value : value.error().message();
  }

  std::unique_ptr<rtapi::Segment> segment_ = rtapi::Segment::in_memory();
  std::unique_ptr<Registry> registry_;
  ComponentRecord* comp_{nullptr};
};

// ---- aliases ------------------------------------------------------------------------------------

TEST_F(MemoryTest, BothNamesFindAnAliasedPin) {
  auto* a = pin("c.a", Type::bit, Dir::in);
  pin("c.b", Type::bit, Dir::in);
  ASSERT_EQ(said(registry_->alias(Kind::pin, "c.a", "nice")), "");
  EXPECT_EQ(registry_->find_pin("c.a"), a);
  EXPECT_EQ(registry_->find_pin("nice"), a);
  EXPECT_EQ(net("s", {"c.a"}), "");
  EXPECT_TRUE(registry_->set_item("c.b", "1").ok());
  const View view(*segment_);
  for (const char* name : {"c.a", "nice"}) {
    const auto info = view.find_pin(name);
    ASSERT_TRUE(info.has_value()) << name;
    EXPECT_EQ(info->name, "nice");
    EXPECT_EQ(info->original_name, "c.a");
    EXPECT_EQ(info->signal, "s");
  }
  EXPECT_EQ(view.find_signal("s")->pins[0].name, "nice");
  EXPECT_EQ(view.find_pin("c.b")->original_name, "");

  ASSERT_EQ(said(registry_->alias(Kind::pin, "nice", "nicer")), "");
  EXPECT_EQ(registry_->find_pin("nice"), nullptr);
  EXPECT_EQ(registry_->find_pin("nicer"), a);
  EXPECT_EQ(view.find_pin("c.a")->original_name, "c.a");
  ASSERT_EQ(said(registry_->unalias(Kind::pin, "nicer")), "");
  EXPECT_EQ(registry_->find_pin("nicer"), nullptr);
  EXPECT_EQ(view.find_pin("c.a")->name, "c.a");
  EXPECT_EQ(said(registry_->unalias(Kind::pin, "c.a")), "");
}

TEST_F(MemoryTest, AnAliasIsANameLikeOthers) {
  pin("c.a", Type::bit, Dir::in);
  pin("c.b", Type::bit, Dir::in);
  (void)registry_->add_param(*comp_, "c.p", Type::bit, Dir::rw, 0);
  EXPECT_EQ(said(registry_->alias(Kind::pin, "c.a", "x")), "");
  for (const char* taken : {"x", "c.a", "c.b"})
    EXPECT_EQ(said(registry_->alias(Kind::pin, "c.b", taken)),
              "duplicate pin/alias name '" + std::string(taken) + "'");
  // Pins and parameters are different objects.
  EXPECT_EQ(said(registry_->alias(Kind::param, "c.p", "x")), "");
  EXPECT_NE(static_cast<void*>(registry_->find_param("x")), registry_->find_pin("x"));
  EXPECT_EQ(said(registry_->alias(Kind::pin, "c.bb", "y")),
            "pin 'c.bb' not found; did you mean 'c.b'?");
  EXPECT_EQ(said(registry_->unalias(Kind::param, "no-such")), "param 'no-such' not found");
  EXPECT_EQ(said(registry_->alias(Kind::pin, "c.b", std::string(56, 'l'))),
            "alias name '" + std::string(56, 'l') + "' is too long");
  EXPECT_FALSE(registry_->add_pin(*comp_, "x", Type::bit, Dir::in, 0).ok());
  EXPECT_THAT(said(registry_->new_signal("x", Type::bit)), HasSubstr("same as a pin"));
}

// ---- ports --------------------------------------------------------------------------------------

TEST_F(MemoryTest, APortCarriesBytesOnceItHasAQueue) {
  pin("c.w", Type::port, Dir::out);
  pin("c.r", Type::port, Dir::in);
  EXPECT_EQ(net("p", {"c.w", "c.r"}), "");
  EXPECT_FALSE(port("c.w").write("x", 1));
  EXPECT_EQ(said(registry_->set_signal("p", "0")), "");
  EXPECT_EQ(said(registry_->set_signal("p", "7")), "");
  EXPECT_EQ(text("p"), "7");
  EXPECT_EQ(text("c.r"), "7");
  EXPECT_EQ(said(registry_->set_signal("p", "7")), "port is already allocated with 7 bytes.");
  Port in = port("c.w");
  Port out = port("c.r");
  char text[8] = {};
  // More often around than the queue is long.
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(in.write("abcde", 5));
    EXPECT_FALSE(in.write("xyz", 3));
    EXPECT_EQ(in.writable(), 2U);
    EXPECT_FALSE(out.read(text, 6));
    EXPECT_TRUE(out.peek(text, 5));
    EXPECT_STREQ(text, "abcde");
    EXPECT_TRUE(out.peek_commit(2));
    EXPECT_EQ(out.readable(), 3U);
    EXPECT_TRUE(out.read(text, 3));
    EXPECT_STREQ(std::string(text, 3).c_str(), "cde");
  }
  EXPECT_TRUE(in.write("abc", 3));
  out.clear();
  EXPECT_EQ(out.readable(), 0U);
  EXPECT_EQ(in.writable(), 7U);
  EXPECT_TRUE(registry_->unlink("c.w").ok());
  EXPECT_EQ(port("c.w").size(), 0U);
  EXPECT_EQ(this->text("c.w"), "0");
}

TEST_F(MemoryTest, OneMayWriteWhileTheOtherReads) {
  pin("c.w", Type::port, Dir::out);
  pin("c.r", Type::port, Dir::in);
  EXPECT_EQ(net("p", {"c.w", "c.r"}), "");
  EXPECT_EQ(said(registry_->set_signal("p", "61")), "");
  constexpr unsigned kBytes = 200'000;
  std::thread writer([port = port("c.w")]() mutable {
    unsigned sent = 0;
    while (sent < kBytes) {
      char data[16];
      const unsigned n = std::min(1 + sent % 16, kBytes - sent);
      for (unsigned i = 0; i < n; ++i) data[i] = static_cast<char>((sent + i) % 251);
      if (port.write(data, n))
        sent += n;
      else
        std::this_thread::yield();
    }
  });
  Port in = port("c.r");
  unsigned wrong = 0;
  for (unsigned got = 0; got < kBytes;) {
    char data[16];
    const unsigned n = std::min(in.readable(), 16U);
    if (n == 0 || !in.read(data, n)) {
      std::this_thread::yield();
      continue;
    }
    for (unsigned i = 0; i < n; ++i)
      if (data[i] != static_cast<char>((got + i) % 251)) ++wrong;
    got += n;
  }
  writer.join();
  EXPECT_EQ(wrong, 0U);
}

TEST_F(MemoryTest, SizesOfPortsAreChecked) {
  pin("c.r", Type::port, Dir::in);
  EXPECT_TRUE(registry_->new_signal("p", Type::port).ok());
  EXPECT_EQ(said(registry_->set_signal("p", "abc")), "value 'abc' invalid for PORT");
  EXPECT_THAT(said(registry_->set_signal("p", "65537")), HasSubstr("65536 is the most"));
  EXPECT_THAT(said(registry_->set_signal("p", "-1")), HasSubstr("65536 is the most"));
  EXPECT_EQ(said(registry_->set_signal("p", "65536")), "");
  // A pin alone has a queue of its own until it is linked.
  EXPECT_EQ(said(registry_->set_item("c.r", "0x10")), "");
  EXPECT_EQ(text("c.r"), "16");
  EXPECT_EQ(net("p", {"c.r"}), "");
  EXPECT_EQ(text("c.r"), "65536");
  EXPECT_TRUE(registry_->delete_signal("p").ok());
  EXPECT_EQ(text("c.r"), "0");
}

// ---- the C API's pins and parameters ------------------------------------------------------------

TEST_F(MemoryTest, TheOwnersPointerFollowsTheLinks) {
  auto* cell = reinterpret_cast<std::uint64_t*>(
      *registry_->allocate_memory(sizeof(std::uint64_t), Region::structure));
  constexpr std::uint64_t kBase = 0x7000'0000'0000;
  auto* a = *registry_->add_pin(*comp_, {.name = "c.a",
                                         .type = Type::s32,
                                         .dir = Dir::out,
                                         .initial = to_raw(-3),
                                         .cell = cell,
                                         .owner_base = kBase});
  EXPECT_EQ(*cell, kBase + a->value);
  EXPECT_EQ(net("s", {"c.a"}), "");
  const Offset of_signal = registry_->find_signal("s")->value;
  EXPECT_EQ(*cell, kBase + of_signal);
  // C code writes the width of its type only.
  const std::int32_t written = -77;
  std::memcpy(segment_->base() + of_signal, &written, sizeof written);
  EXPECT_EQ(text("s"), "-77");
  EXPECT_TRUE(registry_->delete_signal("s").ok());
  EXPECT_EQ(*cell, kBase + a->value);
  EXPECT_EQ(text("c.a"), "-77");
}

TEST_F(MemoryTest, NarrowValuesAreReadInTheirWidth) {
  auto* slot = *registry_->allocate_memory(64, Region::shared);
  std::memset(slot, 0xA5, 64);
  const auto plain = [&](Type type) { return plain_value_text(type, load_value(type, slot)); };
  slot[0] = std::byte{1};
  EXPECT_EQ(plain(Type::bit), "TRUE");
  slot[0] = std::byte{0};
  EXPECT_EQ(plain(Type::bit), "FALSE");
  store_value(Type::s32, slot, to_raw(-2));
  EXPECT_EQ(plain(Type::s32), "-2");
  EXPECT_EQ(plain(Type::u32), "4294967294");
  EXPECT_EQ(slot[4], std::byte{0xA5});
  store_value(Type::floating, slot, to_raw(2.5));
  EXPECT_EQ(plain(Type::floating), "2.5");
}

TEST_F(MemoryTest, AParameterMayStandInTheOwnersMemory) {
  auto* memory = *registry_->allocate_memory(64, Region::structure);
  memory[1] = std::byte{0x77};
  (void)*registry_->add_param(*comp_,
                              {.name = "c.p", .type = Type::bit, .dir = Dir::rw, .native = memory});
  EXPECT_EQ(text("c.p"), "FALSE");
  EXPECT_EQ(said(registry_->set_item("c.p", "true")), "");
  EXPECT_EQ(text("c.p"), "TRUE");
  EXPECT_EQ(memory[0], std::byte{1});
  EXPECT_EQ(memory[1], std::byte{0x77}) << "written wider than its C type";
  double outside = 0;
  EXPECT_THAT(
      registry_
          ->add_param(*comp_,
                      {.name = "c.q", .type = Type::floating, .dir = Dir::rw, .native = &outside})
          .error()
          .message(),
      HasSubstr("must be in memory from hal_malloc"));
  // A program cannot have a value or a pointer where it may not write.
  auto* user = *registry_->add_component("u", ComponentKind::user, 1);
  EXPECT_FALSE(
      registry_
          ->add_param(*user, {.name = "u.p", .type = Type::bit, .dir = Dir::rw, .native = memory})
          .ok());
}

// ---- memory and holders -------------------------------------------------------------------------

TEST_F(MemoryTest, NamedMemoryIsFoundByItsNameAndGoesWithIt) {
  auto* record = *registry_->add_memory("stream-1", 1000, 42);
  const View view(*segment_);
  const auto info = view.find_memory("stream-1");
  ASSERT_TRUE(info.has_value());
  EXPECT_EQ(info->offset, record->memory);
  EXPECT_EQ(info->bytes, 1000U);
  EXPECT_EQ(info->abi, 42U);
  EXPECT_EQ(*view.block<std::byte>("stream-1", 42), segment_->base() + record->memory);
  EXPECT_EQ(view.block<std::byte>("stream-1", 43).error().code, rtapi::Errc::protocol);
  EXPECT_EQ(registry_->add_memory("stream-1", 10, 42).error().code, rtapi::Errc::exists);
  registry_->remove_memory(*record);
  EXPECT_FALSE(view.find_memory("stream-1").has_value());
  EXPECT_EQ(view.block<std::byte>("stream-1", 42).error().code, rtapi::Errc::not_found);
}

TEST_F(MemoryTest, WhatAProcessMayHoldIsReusedOnlyWhenItIsGone) {
  const auto own = [&](Region region) {
    std::byte* memory = *registry_->allocate_memory(200, region);
    memory[10] = std::byte{1};
    registry_->free_memory(memory);
    registry_->reclaim();
    return memory;
  };
  const auto next = [&](Region region) {
    std::byte* memory = *registry_->allocate_memory(200, region);
    EXPECT_EQ(memory[10], std::byte{0});
    registry_->free_memory(memory);
    return memory;
  };
  EXPECT_EQ(next(Region::shared), own(Region::shared));
  const std::uint64_t early = registry_->add_holder();
  std::byte* held = own(Region::shared);
  std::byte* free_at_once = own(Region::structure);
  EXPECT_EQ(next(Region::structure), free_at_once);
  // One that came later cannot have the address.
  const std::uint64_t late = registry_->add_holder();
  for (int i = 0; i < 3; ++i) EXPECT_NE(next(Region::shared), held);
  registry_->remove_holder(early);
  EXPECT_EQ(next(Region::shared), held);
  registry_->remove_holder(late);
}

TEST_F(MemoryTest, ValuesWaitForThoseWhoAskedForThemByName) {
  const auto place_of_a_pin = [&] {
    auto* comp = *registry_->add_component("x", ComponentKind::realtime);
    const Offset value = (*registry_->add_pin(*comp, "x.p", Type::s32, Dir::in, 0))->value;
    registry_->remove_component(*comp);
    registry_->reclaim();
    return value;
  };
  const std::uint64_t ordinary = registry_->add_holder();
  const Offset value = place_of_a_pin();
  EXPECT_EQ(place_of_a_pin(), value) << "a realtime component's pin is nothing that programs hold";
  const std::uint64_t curious = registry_->add_holder(Holds::everything);
  EXPECT_EQ(place_of_a_pin(), value);
  EXPECT_NE(place_of_a_pin(), value);
  registry_->remove_holder(curious);
  EXPECT_EQ(place_of_a_pin(), value);
  registry_->remove_holder(ordinary);
}

TEST_F(MemoryTest, AThousandRoundsOfEverythingDoNotGrow) {
  const std::uint64_t holder = registry_->add_holder();
  std::uint64_t arena = 0;
  for (int i = 0; i < 1000; ++i) {
    auto* comp = *registry_->add_component("x", ComponentKind::realtime, 0, "count=3", true);
    auto* thread = *registry_->add_thread(*comp, "t", 1'000'000);
    for (int p = 0; p < 20; ++p) {
      const std::string name = "x." + std::to_string(p);
      (void)registry_->add_pin(*comp, name, p < 2 ? Type::port : Type::s32, Dir::in, 0);
      EXPECT_TRUE(registry_->alias(Kind::pin, name, "alias-of-" + name).ok());
      auto* function = *registry_->add_function(*comp, name, 0, 0);
      EXPECT_TRUE(registry_->insert_in_run_list(*thread, 0, *function).ok());
    }
    EXPECT_EQ(net("sx", {"x.5", "x.6"}), "");
    EXPECT_EQ(net("px", {"x.0", "x.1"}), "");
    EXPECT_EQ(said(registry_->set_signal("px", std::to_string(1 + i % 1000))), "");
    auto* memory = *registry_->add_memory("m", 100 + static_cast<std::size_t>(i) * 37 % 5000, 1);
    auto* own =
        *registry_->allocate_memory(64 + static_cast<std::size_t>(i) % 7 * 64, Region::structure);
    EXPECT_TRUE(registry_->set_run_list(*thread, {}).ok());
    registry_->remove_component(*comp);
    EXPECT_TRUE(registry_->delete_signal("sx").ok());
    EXPECT_TRUE(registry_->delete_signal("px").ok());
    registry_->free_memory(own);
    // Named memory waits for the holder, so without this it would have to grow.
    registry_->remove_memory(*memory);
    if (i == 0) registry_->remove_holder(holder);
    registry_->reclaim();
    if (i == 20) arena = registry_->arena_bytes();
  }
  EXPECT_EQ(registry_->arena_bytes(), arena);
}

TEST(FullSegment, NothingIsHalfDone) {
  for (const Region full : {Region::structure, Region::shared}) {
    auto segment = rtapi::Segment::in_memory(std::size_t{4} << 20U);
    auto registry = std::move(Registry::create(*segment)).value();
    auto* comp = *registry->add_component("c", ComponentKind::realtime);
    std::vector<std::string> pins;
    for (int i = 0; i < 8; ++i) {
      pins.push_back("c." + std::to_string(i));
      ASSERT_TRUE(registry->add_pin(*comp, pins.back(), Type::port, Dir::in, 0).ok());
    }
    std::vector<std::byte*> pieces;
    for (std::size_t bytes : {std::size_t{65536}, std::size_t{4096}, std::size_t{64}}) {
      for (;;) {
        auto made = registry->allocate_memory(bytes, full);
        if (!made.ok()) {
          EXPECT_THAT(made.error().message(), HasSubstr("[KERF]SEGMENT_MB"));
          break;
        }
        pieces.push_back(*made);
      }
    }
    // What is taken a page at a time may still work for a while.
    int made = 0;
    rtapi::Status said;
    while (said.ok() && made < 5000) {
      const std::string name = "d." + std::to_string(made);
      auto pin = registry->add_pin(*comp, name, Type::bit, Dir::in, 0);
      if (pin.ok())
        ++made;
      else
        said = rtapi::Failure{pin.error()};
    }
    EXPECT_THAT(said.ok() ? "" : said.error().message(), HasSubstr("[KERF]SEGMENT_MB"));
    EXPECT_EQ(registry->find_pin("d." + std::to_string(made)), nullptr);
    said = {};
    for (int i = 0; said.ok() && i < 5000; ++i)
      said = registry->new_signal("s" + std::to_string(i), Type::bit);
    EXPECT_FALSE(said.ok());
    EXPECT_FALSE(registry->net("n", pins).ok());
    EXPECT_EQ(registry->find_signal("n"), nullptr);
    EXPECT_EQ(registry->find_pin("c.0")->signal.get(), 0U);
    if (full == Region::structure) {
      EXPECT_FALSE(registry->alias(Kind::pin, "c.0", "x").ok());
      EXPECT_FALSE(registry->add_function(*comp, "f", 0, 0).ok());
    } else {
      EXPECT_FALSE(registry->set_item("c.0", "4000").ok());
      EXPECT_FALSE(registry->add_memory("m", 4000, 1).ok());
      EXPECT_EQ(registry->find_memory("m"), nullptr);
    }
    auto good = registry->check_invariants();
    EXPECT_TRUE(good.ok()) << good.error().message();
    for (auto* piece : pieces) registry->free_memory(piece);
    EXPECT_TRUE(registry->net("n", pins).ok());
    EXPECT_TRUE(registry->alias(Kind::pin, "c.0", "x").ok());
    good = registry->check_invariants();
    EXPECT_TRUE(good.ok()) << good.error().message();
  }
}

// ---- run lists and size -------------------------------------------------------------------------

TEST_F(MemoryTest, RunListsAreChangedInPlaceAndSeen) {
  auto* thread = *registry_->add_thread(*comp_, "t", 1'000'000);
  std::vector<FunctionRecord*> f;
  for (const char* name : {"f0", "f1", "f2", "f3"})
    f.push_back(*registry_->add_function(*comp_, name, 0, 0));
  const auto names = [&] { return View(*segment_).find_thread("t")->functions; };
  EXPECT_TRUE(registry_->insert_in_run_list(*thread, 0, *f[1]).ok());
  EXPECT_TRUE(registry_->insert_in_run_list(*thread, 0, *f[0]).ok());
  EXPECT_TRUE(registry_->insert_in_run_list(*thread, 2, *f[3]).ok());
  EXPECT_TRUE(registry_->insert_in_run_list(*thread, 2, *f[2]).ok());
  EXPECT_FALSE(registry_->insert_in_run_list(*thread, 9, *f[2]).ok());
  EXPECT_THAT(names(), ElementsAre("f0", "f1", "f2", "f3"));
  registry_->erase_from_run_list(*thread, 1);
  EXPECT_THAT(names(), ElementsAre("f0", "f2", "f3"));
  EXPECT_EQ(f[1]->users, 0U);
  EXPECT_EQ(f[2]->users, 1U);
  EXPECT_TRUE(registry_->check_invariants().ok());
  EXPECT_TRUE(registry_->set_run_list(*thread, {{f[3], f[1]}}).ok());
  EXPECT_THAT(names(), ElementsAre("f3", "f1"));
  EXPECT_EQ(f[0]->users, 0U);
}

TEST_F(MemoryTest, APinHandleFollowsItsLinksAndTheInvariantsWatchIt) {
  Out<double> out;
  In<double> in;
  const auto add = [&](const char* name, Dir dir, PinCell& cell) {
    ItemSpec spec{.name = name, .type = Type::floating, .dir = dir, .cell = cell.word()};
    spec.owner_base = reinterpret_cast<std::uintptr_t>(segment_->base());
    ASSERT_TRUE(registry_->add_pin(*comp_, spec).ok());
  };
  add("h.out", Dir::out, out.place());
  add("h.in", Dir::in, in.place());
  out = 1.5;
  EXPECT_EQ(in.get(), 0);
  ASSERT_EQ(net("s", {"h.out", "h.in"}), "");
  EXPECT_EQ(in.get(), 1.5);
  out = 2.5;
  EXPECT_EQ(in.get(), 2.5);
  ASSERT_TRUE(registry_->unlink("h.in").ok());
  out = 3.5;
  EXPECT_EQ(in.get(), 2.5);
  EXPECT_TRUE(registry_->check_invariants().ok());
  const std::uint64_t good = *in.place().word();
  in.place().point(out.place().slot());
  EXPECT_THAT(registry_->check_invariants().error().message(), HasSubstr("h.in"));
  *in.place().word() = good;
  registry_->remove_component(*comp_);  // before the handles go
}

TEST_F(MemoryTest, TenThousandInstancesFitIntoTheUsualSegment) {
  auto* thread = *registry_->add_thread(*comp_, "t", 1'000'000);
  for (int i = 0; i < 10'000; ++i) {
    const std::string base = "and2." + std::to_string(i);
    for (const char* suffix : {".in0", ".in1", ".out", ".time"})
      ASSERT_TRUE(registry_->add_pin(*comp_, base + suffix, Type::bit, Dir::in, 0).ok()) << i;
    for (const char* suffix : {".tmax", ".tmax-increased"})
      ASSERT_TRUE(registry_->add_param(*comp_, base + suffix, Type::bit, Dir::rw, 0).ok()) << i;
    auto* function = *registry_->add_function(*comp_, base, 0, 0);
    ASSERT_TRUE(
        registry_->insert_in_run_list(*thread, static_cast<std::size_t>(i), *function).ok());
    ASSERT_EQ(net(("s" + base).c_str(), {base + ".in0", base + ".in1"}), "");
    ASSERT_EQ(net("everywhere", {base + ".time"}), "");
  }
  // The pins of one instance share a cache line of links and one of values.
  const auto* first = registry_->find_pin("and2.7777.in0");
  const auto* third = registry_->find_pin("and2.7777.out");
  EXPECT_EQ(third->link - first->link, 16U);
  EXPECT_EQ(third->value - first->value, 16U);
  EXPECT_EQ(View(*segment_).find_thread("t")->functions.size(), 10'000U);
  EXPECT_EQ(View(*segment_).pins().size(), 40'000U);
}

}  // namespace
}  // namespace kerf::hal
