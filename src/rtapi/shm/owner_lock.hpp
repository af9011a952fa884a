// OwnerLock: who may make and remove an instance's segment. An abstract socket address that is bound: the kernel frees it with
// the last process that has it, however that ends, so it can never be left over.
//
// Forked children share the lock until they exec: the launcher's guard, which cleans up after a killed launcher, keeps the next
// start waiting until it has done so.
#pragma once

#include <cstdint>
#include <string>

#include "rtapi/base/result.hpp"

namespace kerf::rtapi {

class OwnerLock {
 public:
  OwnerLock() = default;
  /// busy when somebody has it: names the process, if that lives. A lock whose taker is dead is waited for, up to `patience_ms`.
  static Result<OwnerLock> take(const std::string& instance, int patience_ms);
  /// The process that took the lock: 0 when nobody has it or it cannot be told; it may be dead (see above).
  static std::int64_t taker(const std::string& instance);
  /// True when this process has it, be it by fork.
  static bool held_here(const std::string& instance);

  ~OwnerLock() { release(); }
  OwnerLock(OwnerLock&& other) noexcept : fd_(other.fd_) { other.fd_ = -1; }
  OwnerLock& operator=(OwnerLock&& other) noexcept {
    if (this != &other) {
      release();
      fd_ = other.fd_;
      other.fd_ = -1;
    }
    return *this;
  }
  OwnerLock(const OwnerLock&) = delete;
  OwnerLock& operator=(const OwnerLock&) = delete;
  void release() noexcept;

 private:
  explicit OwnerLock(int fd) : fd_(fd) {}
  int fd_{-1};
};

}  // namespace kerf::rtapi
