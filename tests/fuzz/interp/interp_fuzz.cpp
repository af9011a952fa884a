// The entry that libFuzzer calls; built by tests/fuzz/interp/run.
#include <cstddef>
#include <cstdint>

#include "fuzz/interp/fuzz_program.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  kerf::interp::run_fuzzed({reinterpret_cast<const char*>(data), size});
  return 0;
}
