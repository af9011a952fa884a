#include "hal/client/find_stream.hpp"

#include <string>

namespace kerf::hal {

using rtapi::Errc;
using rtapi::fail;

rtapi::Result<Stream> find_stream(rtapi::Segment& segment, std::uint32_t key,
                                  std::string_view types) {
  const auto name = stream_memory_name(key);
  auto block = segment.find_block(name.c_str(), kStreamAbi);
  Stream stream;
  if (block.ok()) stream = Stream::attach(*block, segment.block_size(name.c_str()));
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
