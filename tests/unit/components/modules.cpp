#include "unit/components/modules.hpp"

#include <algorithm>
#include <stdexcept>

#define KERF_TEST_MODULE(id) extern "C" const ::kerf::hal::Module kerf_hal_module_##id;
#include "modules.inc"
#undef KERF_TEST_MODULE

namespace kerf::components {

const std::vector<const hal::Module*>& all_modules() {
  static const std::vector<const hal::Module*> modules{
#define KERF_TEST_MODULE(id) &kerf_hal_module_##id,
#include "modules.inc"
#undef KERF_TEST_MODULE
  };
  return modules;
}

const hal::Module& module(std::string_view name) {
  std::string dashes(name);
  std::replace(dashes.begin(), dashes.end(), '_', '-');
  for (const hal::Module* m : all_modules()) {
    if (m->info.name == dashes) return *m;
  }
  throw std::logic_error("no component '" + std::string(name) + "' is linked into the test");
}

std::string first_prefix(const hal::Module& module) {
  std::string prefix(module.info.name);
  return module.info.singleton ? prefix : prefix + ".0";
}

}  // namespace kerf::components
