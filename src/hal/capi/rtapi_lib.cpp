// RTAPI but for messages, time and I/O ports: modules, shared memory, text, priorities.
#include <hal.h>
#include <rtapi_string.h>

#include <sys/utsname.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "hal/capi/hal_lib.hpp"
#include "hal/capi/messages.hpp"
#include "hal/capi/realtime_view.hpp"
#include "hal/shared_memory.hpp"
#include "rtapi/sync/cell.hpp"
#include "rtapi/thread/cyclic_thread.hpp"

using namespace kerf::hal::capi;  // NOLINT(google-build-using-namespace): the published names
using kerf::hal::kSharedMemoryAbi;
using kerf::hal::View;

namespace {

constexpr int kMostBlocks = 64;

/// One block that this process uses. Handles are places in the table, from 1.
struct SharedBlock {
  int key{0};
  int users{0};
  kerf::rtapi::Word<std::byte*> memory{nullptr};
};
SharedBlock blocks[kMostBlocks];

SharedBlock* block_of(int handle) {
  if (handle < 1 || handle > kMostBlocks || blocks[handle - 1].memory.get() == nullptr)
    return nullptr;
  return &blocks[handle - 1];
}

std::string block_name(int key) {
  return kerf::hal::shared_memory_name(static_cast<std::uint32_t>(key));
}

}  // namespace

extern "C" {

// ---- modules ------------------------------------------------------------------------------------

int rtapi_init(const char* /*modname*/) {
  static kerf::rtapi::Word<int> last{0};
  const Call call;
  if (call.error() != 0) return call.error();
  return last.add(1);
}

int rtapi_exit(int /*module_id*/) { return 0; }

// ---- shared memory ------------------------------------------------------------------------------

int rtapi_shmem_new(int key, int /*module_id*/, unsigned long size) {
  const Call call;
  if (call.error() != 0) return call.error();
  if (size == 0) return refuse(EINVAL, "rtapi_shmem_new of 0 bytes");
  int free = 0;
  for (int i = kMostBlocks; i > 0; --i) {
    if (blocks[i - 1].users == 0) free = i;
  }
  const std::string name = block_name(key);
  // Whoever came first said how large it is.
  const auto found = View(call->segment()).find_memory(name);
  if (found && found->bytes < size) {
    return refuse(EINVAL, "shared memory with key " + std::to_string(key) + " has " +
                              std::to_string(found->bytes) + " bytes, not " + std::to_string(size));
  }
  int known = 0;
  for (int i = 0; i < kMostBlocks; ++i)
    if (blocks[i].users > 0 && blocks[i].key == key) known = i + 1;
  if (free == 0 && known == 0) return refuse(ENOMEM, "more than 64 blocks of shared memory");
  // Each use is counted with whom it is for, so that the memory lives as long as the last one.
  auto memory = call->add_memory(name, found ? found->bytes : size, kSharedMemoryAbi);
  if (!memory.ok()) return refuse(memory.error());
  // A module that ended without giving its block back leaves a place that holds what is gone.
  if (known > 0 && blocks[known - 1].memory.get() == *memory) {
    ++blocks[known - 1].users;
    return known;
  }
  if (known > 0) free = known;
  SharedBlock& block = blocks[free - 1];
  block.key = key;
  block.users = 1;
  block.memory.publish(*memory);
  return free;
}

int rtapi_shmem_getptr(int handle, void** ptr) {
  SharedBlock* block = block_of(handle);
  if (block == nullptr || ptr == nullptr) return -EINVAL;
  *ptr = block->memory.observe();
  return 0;
}

int rtapi_shmem_delete(int handle, int /*module_id*/) {
  const Call call;
  if (call.error() != 0) return call.error();
  SharedBlock* block = block_of(handle);
  if (block == nullptr) return -EINVAL;
  if (--block->users == 0) block->memory.publish(nullptr);
  if (auto status = call->drop_memory(block_name(block->key)); !status.ok())
    return refuse(status.error());
  return 0;
}

// ---- the machine --------------------------------------------------------------------------------

rtapi_realtime_type_t rtapi_get_realtime_type(void) {
  static const rtapi_realtime_type_t type = [] {
    utsname name{};
    if (std::FILE* file = std::fopen("/sys/kernel/realtime", "r"); file != nullptr) {
      const int c = std::fgetc(file);
      std::fclose(file);
      if (c == '1') return REALTIME_TYPE_PREEMPT_RT;
    }
    if (::uname(&name) != 0) return REALTIME_TYPE_UNKNOWN;
    if (std::strstr(name.version, "PREEMPT_RT") != nullptr) return REALTIME_TYPE_PREEMPT_RT;
    if (std::strstr(name.version, "PREEMPT_DYNAMIC") != nullptr)
      return REALTIME_TYPE_PREEMPT_DYNAMIC;
    return REALTIME_TYPE_NONE;
  }();
  return type;
}

int rtapi_is_realtime(void) {
  return rtapi_get_realtime_type() == REALTIME_TYPE_PREEMPT_RT ? 1 : 0;
}

// ---- text ---------------------------------------------------------------------------------------

char** rtapi_argv_split(rtapi_gfp_t /*flags*/, const char* text, int* argc) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\n'; };
  const std::size_t size = std::strlen(text);
  // The texts stand behind the list, in one piece.
  const std::size_t list_bytes = (size / 2 + 2) * sizeof(char*);
  auto** list = static_cast<char**>(std::calloc(1, list_bytes + size + 1));
  if (list == nullptr) return nullptr;
  char* at = reinterpret_cast<char*>(list) + list_bytes;
  std::memcpy(at, text, size);
  int n = 0;
  while (*at != '\0') {
    while (blank(*at)) *at++ = '\0';
    if (*at == '\0') break;
    list[n++] = at;
    while (*at != '\0' && !blank(*at)) ++at;
  }
  if (argc != nullptr) *argc = n;
  return list;
}

void rtapi_argv_free(char** argv) { std::free(argv); }

char* rtapi_kstrndup(const char* s, size_t most, rtapi_gfp_t /*flags*/) {
  return ::strndup(s, most);
}

}  // extern "C"
