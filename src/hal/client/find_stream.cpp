#include "hal/client/find_stream.hpp"

#include <string>

#include "hal/core/view.hpp"

namespace kerf::hal {

using rtapi::Errc;
using rtapi::fail;

rtapi::Result<Stream> find_stream(rtapi::Segment& segment, std::uint32_t key,
                                  std::string_view types) {
  const auto name = stream_memory_name(key);
  const auto memory = View(segment).find_memory(name);
  Stream stream;
  if (memory && memory->abi == kStreamAbi)
    stream = Stream::attach(segment.base() + memory->offset, memory->bytes);
  if (!stream.valid()) {
    return fail(Errc::not_found, "there is no stream with the key " + std::to_string(key));
  }
  if (!types.empty() && !stream.matches(types)) {
    return fail(Errc::bad_argument, "the stream with the key " + std::to_string(key) +
                                        " has the columns '" + std::string(stream.types()) +
                                        "', not '" + std::string(types) + "'");
  }
  return stream;
}

}  // namespace kerf::hal
