#include "rtapi/shm/segment.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <boost/interprocess/mapped_region.hpp>
#include <boost/interprocess/shared_memory_object.hpp>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <random>

#include "rtapi/base/suggest.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "rtapi/shm/leftovers.hpp"
#include "rtapi/shm/process.hpp"

namespace kerf::rtapi {

namespace bip = boost::interprocess;

namespace {

constexpr std::uint64_t kHeaderAbi = sizeof(SegmentHeader) * 1000 + 2;
/// Memory is put behind the address space in steps of this size.
constexpr std::uint64_t kBackingStep = 1U << 20U;
/// How long a new run waits for those who take down the last one.
constexpr int kTakeDownMs = 5000;
/// How long an owner that lives may take to say that it is ending: it may just have been told so.
constexpr int kNoticeMs = 200;
/// How long one may take that is ending: SHUTDOWN files and programs that do not end at once.
constexpr int kEndingMs = 30'000;
/// Waiting longer than this is worth a line.
constexpr int kTellMs = 300;
/// How long processes of the last run may take to end by themselves.
constexpr int kLeftoversMs = 500;

const char* region_name(Region region) {
  return region == Region::structure ? "structure" : "values and blocks";
}

constexpr std::uint64_t round_up(std::uint64_t n, std::uint64_t to) {
  return (n + to - 1) / to * to;
}

std::string new_run_id() {
  std::random_device source;
  char text[40];
  std::snprintf(text, sizeof text, "%08x%08x-%d", source(), source(), static_cast<int>(getpid()));
  return text;
}

enum class Left { nothing, alive, ending, dead, foreign };

/// Who owns the segment that stands under this name? `run_id` is left empty when it cannot be told.
Left inspect(const std::string& name, std::int64_t& owner, std::string* run_id = nullptr) {
  const int fd = shm_open(name.c_str(), O_RDONLY | O_CLOEXEC, 0);
  if (fd < 0) return Left::nothing;
  Left left = Left::foreign;
  SegmentHeader* header = nullptr;
  struct stat st {};
  if (fstat(fd, &st) == 0 && static_cast<std::size_t>(st.st_size) >= sizeof(SegmentHeader)) {
    void* p = mmap(nullptr, sizeof(SegmentHeader), PROT_READ, MAP_SHARED, fd, 0);
    if (p != MAP_FAILED) header = static_cast<SegmentHeader*>(p);
  }
  if (header != nullptr) {
    // A header without its magic was left in the middle of creation: nobody can be using it.
    owner = header->owner_pid.get();
    const bool alive =
        header->magic == SegmentHeader::kMagic && process_lives(owner, header->owner_start);
    const bool whole = header->magic == SegmentHeader::kMagic && header->abi == kHeaderAbi;
    left = !alive ? Left::dead : whole && header->ending.get() != 0 ? Left::ending : Left::alive;
    if (run_id != nullptr && whole) *run_id = std::string(header->run_id.view());
    munmap(header, sizeof(SegmentHeader));
  } else {
    left = Left::dead;
  }
  close(fd);
  return left;
}

/// The owner's lock, also after a run that is about to end.
Result<OwnerLock> take_over(const std::string& instance, const MakeHooks& hooks) {
  const auto clock = make_real_clock();
  const Nanos begin = clock->now();
  for (bool told = false;;) {
    auto lock = OwnerLock::take(instance, kTakeDownMs);
    if (lock.ok() || lock.error().code != Errc::busy) return lock;
    std::int64_t owner = 0;
    // An owner that is ending says so, or has taken its number out of the header, then the name away.
    const Left left = inspect(segment_name(instance), owner);
    const Nanos patience = (left == Left::alive    ? kNoticeMs
                            : left == Left::ending ? kEndingMs
                                                   : kTakeDownMs) *
                           kMillisecond;
    const Nanos waited = clock->now() - begin;
    if (owner == getpid() || waited > patience) return lock;
    if (!told && hooks.waits && waited > kTellMs * kMillisecond) {
      told = true;
      hooks.waits("instance '" + instance + "' is still being taken down" +
                  (owner > 0 ? " by process " + std::to_string(owner) : std::string()) +
                  "; waiting for its end");
    }
    WaitSpec spec;
    spec.wake_at(clock->now() + 5 * kMillisecond);
    clock->wait(spec);
  }
}

}  // namespace

struct Segment::Mapping {
  bip::shared_memory_object object;
  bip::mapped_region region;
  void* private_memory{nullptr};
  std::size_t private_bytes{0};
  int fd{-1};
  ~Mapping() {
    if (private_memory != nullptr) munmap(private_memory, private_bytes);
  }
};

Result<std::unique_ptr<Segment>> Segment::create(const std::string& instance, std::size_t bytes,
                                                 const MakeHooks& hooks) {
  if (!valid_instance_name(instance))
    return fail(Errc::bad_argument,
                "instance name '" + instance +
                    "' may only have letters, digits, '-', '_' and '.', at most 40");
  if (bytes < 2 * kBackingStep || bytes > kMostBytes)
    return fail(Errc::bad_argument, "[KERF]SEGMENT_MB is " + std::to_string(bytes >> 20U) +
                                        ", but must be between 2 and " +
                                        std::to_string(kMostBytes >> 20U));
  const std::string name = segment_name(instance);
  // From here on nobody else makes or removes a segment of this name. What stands there is dead, however far its maker came.
  KERF_TRY(OwnerLock lock, take_over(instance, hooks));
  std::int64_t owner = 0;
  std::string old_run;
  const Left left = inspect(name, owner, &old_run);
  if (left == Left::alive || left == Left::ending) {
    return fail(Errc::busy, "instance '" + instance + "' is in use by process " +
                                std::to_string(owner) + " (" + process_name(owner) +
                                "); stop it, or choose another name with --instance");
  }
  if (left != Left::nothing) {
    // They listen on the instance's addresses and hold its devices.
    (void)end_processes_of_run(old_run, kLeftoversMs);
    shm_unlink(name.c_str());
  }
  const std::string run_id = new_run_id();
  if (hooks.taken) KERF_CHECK(hooks.taken(run_id));
  auto segment = std::unique_ptr<Segment>(new Segment());
  segment->lock_ = std::move(lock);
  segment->mapping_ = std::make_unique<Mapping>();
  try {
    segment->mapping_->object = bip::shared_memory_object(bip::create_only, name.c_str() + 1,
                                                          bip::read_write, bip::permissions(0600));
    segment->mapping_->object.truncate(static_cast<bip::offset_t>(bytes));
    segment->mapping_->region =
        bip::mapped_region(segment->mapping_->object, bip::read_write, 0, bytes);
  } catch (const bip::interprocess_exception& e) {
    return fail(Errc::system, std::string("cannot make shared memory ") + name + ": " + e.what());
  }
  segment->mapping_->fd = segment->mapping_->object.get_mapping_handle().handle;
  segment->base_ = static_cast<std::byte*>(segment->mapping_->region.get_address());
  segment->bytes_ = bytes;
  segment->instance_ = instance;
  segment->owner_ = true;
  if (posix_fallocate(segment->mapping_->fd, 0, static_cast<off_t>(kBackingStep)) != 0) {
    shm_unlink(name.c_str());
    return fail(Errc::no_memory, "no memory behind " + name + "; is /dev/shm full?");
  }
  segment->lay_out(bytes);
  SegmentHeader& header = segment->header();
  header.owner_start = process_start_time(getpid());
  header.run_id = FixedString<63>(run_id);
  header.magic = SegmentHeader::kMagic;
  return segment;
}

void Segment::lay_out(std::size_t bytes) {
  static_assert(sizeof(SegmentHeader) < kBackingStep);
  auto* header = new (base_) SegmentHeader();
  header->abi = kHeaderAbi;
  header->size = bytes;
  header->owner_pid.set(getpid());
  auto& structure = header->regions[static_cast<std::size_t>(Region::structure)];
  auto& shared = header->regions[static_cast<std::size_t>(Region::shared)];
  structure.end = shared.begin = bytes / 2 / kBackingStep * kBackingStep;
  shared.end = bytes;
  structure.used.set(round_up(sizeof(SegmentHeader), 64));
  structure.backed.set(kBackingStep);
  shared.used.set(shared.begin);
  shared.backed.set(shared.begin);
}

Result<std::unique_ptr<Segment>> Segment::attach(const std::string& instance, Access access) {
  const std::string name = segment_name(instance);
  auto segment = std::unique_ptr<Segment>(new Segment());
  segment->mapping_ = std::make_unique<Mapping>();
  std::int64_t owner = 0;
  const Left left = inspect(name, owner);
  if (left == Left::nothing)
    return fail(Errc::not_found, "instance '" + instance + "' does not run (no shared memory " +
                                     name + "); start it with kerf or halrun");
  try {
    segment->mapping_->object =
        bip::shared_memory_object(bip::open_only, name.c_str() + 1, bip::read_write);
    bip::offset_t size = 0;
    if (!segment->mapping_->object.get_size(size) ||
        static_cast<std::size_t>(size) < sizeof(SegmentHeader))
      return fail(Errc::protocol, "shared memory " + name +
                                      " is of another version; stop the instance that made it");
    segment->mapping_->region = bip::mapped_region(segment->mapping_->object, bip::read_write, 0,
                                                   static_cast<std::size_t>(size));
    segment->bytes_ = static_cast<std::size_t>(size);
  } catch (const bip::interprocess_exception& e) {
    return fail(Errc::system, std::string("cannot map shared memory ") + name + ": " + e.what());
  }
  segment->mapping_->fd = segment->mapping_->object.get_mapping_handle().handle;
  segment->base_ = static_cast<std::byte*>(segment->mapping_->region.get_address());
  segment->instance_ = instance;
  const SegmentHeader& header = segment->header();
  if (header.magic == 0)
    return fail(Errc::not_found, "instance '" + instance +
                                     "' is not ready yet; if it stays so, its start has failed and "
                                     "'halrun -U' cleans up");
  if (header.magic != SegmentHeader::kMagic || header.abi != kHeaderAbi)
    return fail(Errc::protocol, "shared memory " + name +
                                    " was made by another build of Kerf; stop that instance first");
  segment->whole_ = access == Access::whole;
  if (!segment->whole_ &&
      mprotect(segment->base_, segment->region(Region::structure).end, PROT_READ) != 0)
    return fail(Errc::system, "cannot protect shared memory " + name);
  return segment;
}

std::unique_ptr<Segment> Segment::in_memory(std::size_t bytes, const std::string& instance) {
  auto segment = std::unique_ptr<Segment>(new Segment());
  segment->mapping_ = std::make_unique<Mapping>();
  // Untouched pages cost nothing, so a fork copies only what the machine really uses.
  void* p = mmap(nullptr, bytes, PROT_READ | PROT_WRITE,
                 MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (p == MAP_FAILED) std::abort();
  segment->mapping_->private_memory = p;
  segment->mapping_->private_bytes = bytes;
  segment->base_ = static_cast<std::byte*>(p);
  segment->bytes_ = bytes;
  segment->instance_ = instance;
  segment->lay_out(bytes);
  SegmentHeader& header = segment->header();
  for (RegionHead& region : header.regions) region.backed.set(region.end);
  header.run_id = FixedString<63>("private");
  header.magic = SegmentHeader::kMagic;
  return segment;
}

bool Segment::remove(const std::string& instance) {
  const std::string name = segment_name(instance);
  std::int64_t owner = 0;
  OwnerLock lock;
  if (!OwnerLock::held_here(instance)) {
    auto taken = OwnerLock::take(instance, 0);
    if (!taken.ok()) return inspect(name, owner) == Left::nothing;
    lock = std::move(*taken);
  }
  const Left left = inspect(name, owner);
  if (left == Left::nothing) return true;
  if ((left == Left::alive || left == Left::ending) && owner != getpid()) return false;
  return shm_unlink(name.c_str()) == 0;
}

Segment::~Segment() {
  // The owner takes the name away; others keep their mapping until they let go.
  if (owner_ && header().owner_pid.get() == getpid()) shm_unlink(segment_name(instance_).c_str());
}

Result<Offset> Segment::extend(Region region, std::size_t bytes) {
  if (!whole_)
    return fail(Errc::permission, "only the maker of " + segment_name(instance_) +
                                      " and rtapi_app take memory of it");
  RegionHead& r = header().regions[static_cast<std::size_t>(region)];
  const Offset offset = r.used.get();
  if (bytes > r.end - offset || round_up(bytes, 64) > r.end - offset)
    return fail(Errc::no_memory, "the shared memory of " + std::to_string(bytes_ >> 20U) +
                                     " MiB is full (its half for " + region_name(region) +
                                     "); raise [KERF]SEGMENT_MB");
  const Offset end = offset + round_up(bytes, 64);
  if (const Offset backed = r.backed.get(); end > backed) {
    const Offset more = std::min(round_up(end, kBackingStep), r.end);
    if (posix_fallocate(mapping_->fd, static_cast<off_t>(backed),
                        static_cast<off_t>(more - backed)) != 0)
      return fail(Errc::no_memory, "/dev/shm is full: no memory for " +
                                       std::to_string((more - backed) >> 20U) + " MiB more of " +
                                       segment_name(instance_));
    r.backed.set(more);
  }
  r.used.set(end);
  return offset;
}

Result<std::byte*> Segment::make_block(const char* name, std::size_t bytes, std::uint64_t abi,
                                       Region region) {
  BlockEntry* free_entry = nullptr;
  for (BlockEntry& entry : header().blocks) {
    if (entry.state.observe() == 0) {
      if (free_entry == nullptr) free_entry = &entry;
    } else if (entry.name == std::string_view(name)) {
      return fail(Errc::exists, std::string("segment block '") + name + "' exists already");
    }
  }
  if (free_entry == nullptr)
    return fail(Errc::no_memory, std::string("no room for segment block '") + name + "': " +
                                     std::to_string(SegmentHeader::kBlocks) + " blocks are in use");
  KERF_TRY(const Offset offset, extend(region, bytes));
  std::memset(static_cast<void*>(base_ + offset), 0, bytes);
  free_entry->name = FixedString<47>(name);
  free_entry->abi = abi;
  free_entry->offset = offset;
  free_entry->size = bytes;
  free_entry->state.publish(1);
  return base_ + offset;
}

Result<std::byte*> Segment::find_block(const char* name, std::uint64_t abi) const {
  for (const BlockEntry& entry : header().blocks) {
    if (entry.state.observe() != 1 || !(entry.name == std::string_view(name))) continue;
    if (entry.abi != abi)
      return fail(Errc::protocol,
                  std::string("segment block '") + name + "' was made by another build of Kerf");
    if (entry.offset + entry.size > bytes_)
      return fail(Errc::protocol, std::string("segment block '") + name + "' is damaged");
    return base_ + entry.offset;
  }
  return fail(Errc::not_found, std::string("segment block '") + name + "' does not exist");
}

std::size_t Segment::block_size(const char* name) const {
  for (const BlockEntry& entry : header().blocks)
    if (entry.state.observe() == 1 && entry.name == std::string_view(name)) return entry.size;
  return 0;
}

void Segment::drop_block(const char* name) {
  for (BlockEntry& entry : header().blocks)
    if (entry.state.observe() == 1 && entry.name == std::string_view(name)) entry.state.publish(0);
}

std::string default_instance() {
  const char* given = std::getenv("KERF_INSTANCE");
  if (given != nullptr && *given != '\0') return given;
  return "u" + std::to_string(getuid());
}

std::string segment_name(const std::string& instance) { return "/kerf-" + instance; }

std::string socket_name(const std::string& instance, const std::string& service) {
  return "kerf-" + instance + "-" + service;
}

bool valid_instance_name(const std::string& instance) {
  if (instance.empty() || instance.size() > 40) return false;
  for (const char c : instance) {
    const bool ok = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                    c == '-' || c == '_' || c == '.';
    if (!ok) return false;
  }
  return true;
}

}  // namespace kerf::rtapi
