// Plain memory that programs and components find by a number: rtapi_shmem_* of the C API, hal.shm of Python.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>

namespace kerf::hal {

/// Says of named memory that it is such memory; its content is the users' business.
inline constexpr std::uint64_t kSharedMemoryAbi = 0x6b73'686d'0000'0001ULL;

/// Name of the memory with a key: "shmem-000004d2".
inline std::string shared_memory_name(std::uint32_t key) {
  char text[24];
  std::snprintf(text, sizeof text, "shmem-%08x", static_cast<unsigned>(key));
  return text;
}

}  // namespace kerf::hal
