// A component of a test's own as a module that loadrt finds.
#pragma once

#include <memory>
#include <new>

#include "hal/component.hpp"

namespace kerf::hal::test {

template <class C>
constexpr Module module_of() {
  return Module{kModuleAbi,
                C::kInfo,
                sizeof(C),
                alignof(C),
                [](void* storage, Builder& b) noexcept { new (storage) C(b); },
                [](void* object) noexcept { std::destroy_at(static_cast<C*>(object)); }};
}

}  // namespace kerf::hal::test
