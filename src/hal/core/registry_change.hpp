// Private to the two files of Registry.
#pragma once

#include <atomic>

#include "hal/core/registry.hpp"

namespace kerf::hal {

/// Keeps the generation odd, so that readers retry, and tells waiters at the end.
class Registry::Change {
 public:
  explicit Change(Root& root) : root_(root) {
    root_.generation.set(root_.generation.get() + 1);
    // Readers that see a changed record must also see the odd count.
    std::atomic_thread_fence(std::memory_order_release);
  }
  ~Change() {
    root_.generation.publish(root_.generation.get() + 1);
    root_.changed.notify();
  }
  Change(const Change&) = delete;
  Change& operator=(const Change&) = delete;

 private:
  Root& root_;
};

}  // namespace kerf::hal
