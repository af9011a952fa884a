// Segment: the one piece of shared memory of an instance, and the directory of blocks in it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <new>
#include <string>
#include <type_traits>

#include "rtapi/base/fixed_string.hpp"
#include "rtapi/base/result.hpp"
#include "rtapi/shm/owner_lock.hpp"
#include "rtapi/sync/cell.hpp"

namespace kerf::rtapi {

/// A place in the segment, as bytes from its base; 0 is nowhere.
using Offset = std::uint64_t;

/// The two parts of the segment. `structure` says what there is (records, links): clients map it read-only, so none can damage it,
/// however it fails. `shared` is what programs write too: values, blocks, rings.
enum class Region : std::uint32_t { structure = 0, shared = 1 };
inline constexpr std::size_t kRegions = 2;

/// What a process may write: a client only `shared`, the instance's maker and the realtime host everything.
enum class Access { client, whole };

struct RegionHead {
  Offset begin{0}, end{0};
  Word<Offset> used{0};    ///< handed out up to here
  Word<Offset> backed{0};  ///< memory is behind it up to here
};

struct BlockEntry {
  FixedString<47> name;
  std::uint64_t abi{0};
  Offset offset{0};
  std::uint64_t size{0};
  Word<std::uint32_t> state{0};  ///< 0 free, 1 present
};

struct SegmentHeader {
  static constexpr std::uint64_t kMagic = 0x31'6d'67'65'73'66'72'6bULL;  // "krfsegm1"
  static constexpr std::size_t kBlocks = 128;
  std::uint64_t magic{0};  ///< written last by the maker
  std::uint64_t abi{0};    ///< of this header
  std::uint64_t size{0};   ///< reserved bytes
  Word<std::int64_t> owner_pid{0};
  std::uint64_t owner_start{0};  ///< start time of the owner (/proc/PID/stat): tells a reused pid
  Word<std::uint32_t> ending{
      0};                        ///< 1: the owner takes the instance down; a new start waits for it
  FixedString<63> run_id;        ///< unique a start; children carry it as KERF_RUN_ID
  RegionHead regions[kRegions];  ///< this header is the first thing in `structure`
  BlockEntry blocks[kBlocks];
};

/// What whoever makes an instance wants to know on the way.
struct MakeHooks {
  /// The start waits for the end of the run before: a line for people, once.
  std::function<void(const std::string&)> waits;
  /// The instance is ours and nothing of it exists yet. A guard that is forked here shares the OwnerLock and sees all that is left,
  /// at whatever instruction the maker dies. A failure ends create().
  std::function<Status(const std::string& run_id)> taken;
};

/// Mapping of the segment. Address space for the whole size is reserved at attach and never moves; memory is put behind it
/// piece by piece, so that a full machine is an error that names `[KERF]SEGMENT_MB`, never a SIGBUS.
///
/// Each region has half of the address space. Blocks are made by one process at a time (the launcher before the host starts,
/// then the realtime host) and are never given back; their content is the maker's business.
class Segment {
 public:
  static constexpr std::size_t kDefaultBytes = 64U << 20U;
  /// Places in the segment fit 31 bits: handles of ports are so wide.
  static constexpr std::size_t kMostBytes = 2047U << 20U;

  /// Makes the instance's segment, and holds the instance's OwnerLock as long as it lives. What a dead owner left, its processes
  /// too, is removed first; one that is taking the instance down is waited for; a live owner is an error that names it.
  static Result<std::unique_ptr<Segment>> create(const std::string& instance,
                                                 std::size_t bytes = kDefaultBytes,
                                                 const MakeHooks& hooks = {});
  /// Maps the instance's segment. not_found when the instance does not run; protocol when another build made it. A client that
  /// writes to `structure` all the same dies of SIGSEGV.
  static Result<std::unique_ptr<Segment>> attach(const std::string& instance,
                                                 Access access = Access::client);
  /// Private memory of this process, for tests. Copied by fork like all memory.
  static std::unique_ptr<Segment> in_memory(std::size_t bytes = kDefaultBytes,
                                            const std::string& instance = "private");
  /// Removes the name of an instance's segment, if its owner is dead or is this process and nobody else has the OwnerLock. True
  /// when nothing is left.
  static bool remove(const std::string& instance);

  ~Segment();
  Segment(const Segment&) = delete;
  Segment& operator=(const Segment&) = delete;

  [[nodiscard]] std::byte* base() const noexcept { return base_; }
  [[nodiscard]] SegmentHeader& header() const noexcept {
    return *reinterpret_cast<SegmentHeader*>(base_);
  }
  [[nodiscard]] const std::string& instance() const noexcept { return instance_; }
  /// The owner takes the instance down from here on: the next start of it waits instead of refusing.
  void begin_end() noexcept { header().ending.set(1); }

  /// Takes fresh memory, zero-filled and aligned to 64, off a region for good. no_memory: it is full; permission: a client asked.
  Result<Offset> extend(Region region, std::size_t bytes);
  [[nodiscard]] const RegionHead& region(Region region) const noexcept {
    return header().regions[static_cast<std::size_t>(region)];
  }
  /// True when all of the bytes have been handed out.
  [[nodiscard]] bool in_use(Offset offset, std::size_t bytes) const noexcept {
    for (const RegionHead& r : header().regions) {
      const Offset end = r.used.get();
      if (offset >= r.begin && offset < end) return bytes <= end - offset;
    }
    return false;
  }

  /// Makes a zero-filled block, aligned to 64. exists: the name is taken; otherwise as extend().
  Result<std::byte*> make_block(const char* name, std::size_t bytes, std::uint64_t abi,
                                Region region = Region::shared);
  /// not_found; protocol when the abi differs.
  [[nodiscard]] Result<std::byte*> find_block(const char* name, std::uint64_t abi) const;
  [[nodiscard]] std::size_t block_size(const char* name) const;
  /// Forgets a block's name (the memory is kept: somebody may hold its address).
  void drop_block(const char* name);

  template <class T>
  Result<T*> make(const char* name, std::uint64_t abi = sizeof(T), Region region = Region::shared) {
    auto block = make_block(name, sizeof(T), abi, region);
    if (!block.ok()) return Failure{block.error()};
    return new (*block) T();
  }
  template <class T>
  [[nodiscard]] Result<T*> find(const char* name, std::uint64_t abi = sizeof(T)) const {
    auto block = find_block(name, abi);
    if (!block.ok()) return Failure{block.error()};
    return std::launder(reinterpret_cast<T*>(*block));
  }

  template <class T>
  [[nodiscard]] T* at(Offset offset) const noexcept {
    return reinterpret_cast<T*>(base_ + offset);
  }
  [[nodiscard]] Offset offset_of(const void* p) const noexcept {
    return static_cast<Offset>(static_cast<const std::byte*>(p) - base_);
  }
  /// True when `p` points into the segment.
  [[nodiscard]] bool contains(const void* p) const noexcept {
    const auto* b = static_cast<const std::byte*>(p);
    return b >= base_ && b < base_ + bytes_;
  }

 private:
  Segment() = default;
  void lay_out(std::size_t bytes);
  struct Mapping;  ///< hides Boost.Interprocess
  std::unique_ptr<Mapping> mapping_;
  std::byte* base_{nullptr};
  std::size_t bytes_{0};
  std::string instance_;
  bool owner_{false};
  OwnerLock lock_;    ///< let go after the name is gone
  bool whole_{true};  ///< may write `structure`
};

/// Names of an instance's things. `KERF_INSTANCE` or, without it, "u" and the user id.
std::string default_instance();
/// "/kerf-INSTANCE", the shm_open name.
std::string segment_name(const std::string& instance);
/// Abstract socket address of a service ("hal", "task", "clock-3") of the instance, without the leading zero byte.
std::string socket_name(const std::string& instance, const std::string& service);
/// False for a name with anything but letters, digits, '-', '_' and '.', or longer than 40.
bool valid_instance_name(const std::string& instance);

}  // namespace kerf::rtapi
