#include "rtapi/shm/segment.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "rtapi/log/log.hpp"
#include "rtapi/shm/process.hpp"
#include "rtapi/shm/socket.hpp"

namespace kerf::rtapi {
namespace {

std::string unique_instance(const char* what) {
  return std::string("test-") + what + "-" + std::to_string(getpid());
}

bool name_exists(const std::string& instance) {
  return access(("/dev/shm" + segment_name(instance)).c_str(), F_OK) == 0;
}

TEST(Segment, BlocksAreFoundByOthersAndTheNameGoesWithTheOwner) {
  const std::string instance = unique_instance("blocks");
  {
    auto made = Segment::create(instance);
    ASSERT_TRUE(made.ok()) << made.error().message();
    auto cell = (*made)->make<Cell>("a-cell");
    ASSERT_TRUE(cell.ok());
    auto attached = Segment::attach(instance);
    ASSERT_TRUE(attached.ok()) << attached.error().message();
    auto found = (*attached)->find<Cell>("a-cell");
    ASSERT_TRUE(found.ok());
    (*cell)->notify();
    EXPECT_EQ((*found)->count(), 1U);
    EXPECT_EQ((*attached)->find<Cell>("b-cell").error().code, Errc::not_found);
    EXPECT_EQ((*attached)->find<Cell>("a-cell", 77).error().code, Errc::protocol);
    EXPECT_EQ((*made)->make<Cell>("a-cell").error().code, Errc::exists);
    EXPECT_TRUE(name_exists(instance));
  }
  EXPECT_FALSE(name_exists(instance));
}

TEST(Segment, FullIsAnErrorThatNamesTheKey) {
  auto segment = Segment::create(unique_instance("full"), 4U << 20U);
  ASSERT_TRUE(segment.ok());
  const auto block = (*segment)->make_block("big", 5U << 20U, 1);
  ASSERT_FALSE(block.ok());
  EXPECT_NE(block.error().message().find("[KERF]SEGMENT_MB"), std::string::npos);
}

TEST(Segment, AClientMayWriteValuesButNotTheStructure) {
  const std::string instance = unique_instance("regions");
  auto made = Segment::create(instance);
  ASSERT_TRUE(made.ok());
  auto structure = (*made)->make<Word<int>>("structure", 1, Region::structure);
  auto value = (*made)->make<Word<int>>("value", 1, Region::shared);
  ASSERT_TRUE(structure.ok() && value.ok());
  // How a process ends that maps the segment and writes to a block, and what then stands there.
  const auto write = [&](const char* block, Access access) {
    const pid_t child = fork();
    if (child == 0) {
      signal(SIGSEGV, SIG_DFL);  // a sanitizer's handler would exit
      auto own = Segment::attach(instance, access);
      if (!own.ok()) _exit(1);
      (*(*own)->find<Word<int>>(block, 1))->set(5);
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
  };
  EXPECT_EQ(write("structure", Access::client), -SIGSEGV);
  EXPECT_EQ((*structure)->get(), 0);
  EXPECT_EQ(write("value", Access::client), 0);
  EXPECT_EQ((*value)->get(), 5);
  EXPECT_EQ(write("structure", Access::whole), 0);
  EXPECT_EQ((*structure)->get(), 5);
  auto client = Segment::attach(instance);
  ASSERT_TRUE(client.ok());
  EXPECT_EQ((*client)->make<Word<int>>("mine").error().code, Errc::permission);
}

TEST(Segment, EachRegionIsFullByItself) {
  auto segment = Segment::create(unique_instance("halves"), 8U << 20U);
  ASSERT_TRUE(segment.ok());
  EXPECT_TRUE((*segment)->extend(Region::structure, 3U << 20U).ok());
  const auto full = (*segment)->extend(Region::structure, 2U << 20U);
  ASSERT_FALSE(full.ok());
  EXPECT_NE(full.error().message().find("[KERF]SEGMENT_MB"), std::string::npos);
  EXPECT_EQ((*segment)->extend(Region::shared, SIZE_MAX).error().code, Errc::no_memory);
  auto last = (*segment)->extend(Region::shared, 4U << 20U);
  ASSERT_TRUE(last.ok());
  std::memset((*segment)->base() + *last, 1, 4U << 20U);  // memory is behind all of it
  EXPECT_TRUE((*segment)->in_use(*last, 4U << 20U));
  EXPECT_FALSE((*segment)->in_use(*last + 1, 4U << 20U));
  EXPECT_FALSE((*segment)->in_use((4U << 20U) - 1, 1));
  EXPECT_EQ(Segment::create(unique_instance("large"), std::size_t{4} << 30U).error().code,
            Errc::bad_argument);
}

TEST(Segment, LiveOwnerIsRefusedByName) {
  const std::string instance = unique_instance("live");
  auto first = Segment::create(instance);
  ASSERT_TRUE(first.ok());
  const auto second = Segment::create(instance);
  ASSERT_FALSE(second.ok());
  EXPECT_NE(second.error().message().find(std::to_string(getpid())), std::string::npos);
}

TEST(Segment, LeftOverOfADeadOwnerIsReplaced) {
  const std::string instance = unique_instance("dead");
  const pid_t child = fork();
  if (child == 0) {
    auto made = Segment::create(instance);
    _exit(made.ok() ? 0 : 1);  // no destructor: the name stays
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_EQ(WEXITSTATUS(status), 0);
  ASSERT_TRUE(name_exists(instance));
  auto again = Segment::create(instance);
  EXPECT_TRUE(again.ok()) << again.error().message();
}

TEST(Segment, ThatOfAnotherBuildIsNamedWhileItLivesAndReplacedWhenItIsDead) {
  const std::string instance = unique_instance("other");
  {
    auto made = Segment::create(instance);
    ASSERT_TRUE(made.ok());
    ++(*made)->header().abi;
    const auto attached = Segment::attach(instance);
    ASSERT_FALSE(attached.ok());
    EXPECT_EQ(attached.error().code, Errc::protocol);
    EXPECT_NE(attached.error().message().find(segment_name(instance)), std::string::npos);
    EXPECT_NE(attached.error().message().find("another build"), std::string::npos);
    const auto second = Segment::create(instance);
    ASSERT_FALSE(second.ok());
    EXPECT_EQ(second.error().code, Errc::busy);
  }
  // Left behind, too short for a header of today, or with nothing in it.
  for (const off_t bytes : {off_t{0}, off_t{100}, off_t{4096}}) {
    const int fd = shm_open(segment_name(instance).c_str(), O_RDWR | O_CREAT | O_EXCL, 0600);
    ASSERT_GE(fd, 0);
    ASSERT_EQ(ftruncate(fd, bytes), 0);
    close(fd);
    EXPECT_FALSE(Segment::attach(instance).ok()) << bytes;
    const auto again = Segment::create(instance);
    EXPECT_TRUE(again.ok()) << bytes << again.error().message();
  }
  EXPECT_FALSE(name_exists(instance));
}

TEST(Segment, BadInstanceName) {
  EXPECT_EQ(Segment::create("a/b").error().code, Errc::bad_argument);
  EXPECT_EQ(Segment::attach(unique_instance("nobody")).error().code, Errc::not_found);
}

TEST(Sockets, PacketsInOrderAndEndOfFile) {
  const std::string address = socket_name(unique_instance("sock"), "x");
  auto listener = listen_seqpacket(address);
  ASSERT_TRUE(listener.ok());
  auto client = connect_seqpacket(address);
  ASSERT_TRUE(client.ok());
  auto server = accept_seqpacket(*listener);
  ASSERT_TRUE(server.ok() && server->has_value());
  EXPECT_FALSE(receive_packet(**server)->has_value());
  ASSERT_TRUE(send_packet(*client, "one").ok());
  ASSERT_TRUE(send_packet(*client, std::string(100000, 'x')).ok());
  EXPECT_EQ(**receive_packet(**server), "one");
  EXPECT_EQ((*receive_packet(**server))->size(), 100000U);
  EXPECT_EQ(peer_pid(**server), getpid());
  close_fd(*client);
  EXPECT_EQ(receive_packet(**server).error().code, Errc::dead);
  close_fd(**server);
  close_fd(*listener);
  EXPECT_EQ(connect_seqpacket(address).error().code, Errc::not_found);
}

TEST(Process, DeadAndReusedNumbers) {
  EXPECT_TRUE(process_lives(getpid(), process_start_time(getpid())));
  EXPECT_FALSE(process_lives(getpid(), 1));
  const pid_t child = fork();
  if (child == 0) _exit(0);
  waitpid(child, nullptr, 0);
  EXPECT_FALSE(process_lives(child, 0));
}

TEST(LogRing, ReaderGetsEachMessageOnce) {
  LogRing ring;
  LogReader reader(ring);
  ring.write(Level::error, "joint", 1, 2, 0, 0, 2);
  ring.write(Level::error, "two");
  testing::internal::CaptureStderr();
  EXPECT_EQ(reader.drain(), 2);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "kerf: error: joint 1 2\nkerf: error: two\n");
  EXPECT_EQ(reader.drain(), 0);
}

}  // namespace
}  // namespace kerf::rtapi
