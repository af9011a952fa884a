// Streams and waiting for ports.
#include <hal.h>

#include <cerrno>
#include <string>

#include "hal/capi/hal_lib.hpp"
#include "hal/stream.hpp"

using namespace kerf::hal::capi;  // NOLINT(google-build-using-namespace): the published names
using kerf::hal::kStreamAbi;
using kerf::hal::Stream;
using kerf::hal::View;
namespace hal = kerf::hal;

namespace {

std::string memory_name(int key) {
  return std::string(hal::stream_memory_name(static_cast<std::uint32_t>(key)).view());
}

int refuse_stream(const std::string& text) {
  rtapi_print_msg(RTAPI_MSG_ERR, "stream: ERROR: %s\n", text.c_str());
  return -EINVAL;
}

void fill_in(hal_stream_t* stream, int comp_id, int key, const Stream& view) {
  stream->comp_id = comp_id;
  stream->shmem_id = key;
  stream->fifo = new Stream(view);
}

void forget(hal_stream_t* stream) {
  delete static_cast<Stream*>(stream->fifo);
  stream->fifo = nullptr;
}

}  // namespace

extern "C" {

int hal_stream_create(hal_stream_t* stream, int comp_id, int key, unsigned depth,
                      const char* types) {
  const Call call;
  if (call.error() != 0) return call.error();
  if (call->find_component(comp_id) == nullptr)
    return refuse(EINVAL, "component " + std::to_string(comp_id) + " not found");
  const std::string letters = types == nullptr ? "" : types;
  if (letters.size() > HAL_STREAM_MAX_PINS)
    return refuse_stream("more than " + std::to_string(HAL_STREAM_MAX_PINS) + " items");
  for (const char letter : letters) {
    if (hal::stream_type(letter) == hal::Type::unspecified) {
      return refuse_stream(std::string("unknown type '") + letter +
                           "', must be F, B, U, S, K, or L");
    }
  }
  if (letters.empty()) return refuse_stream("no items");
  if (depth == 0 || depth > hal::kMaxStreamDepth)
    return refuse_stream("depth " + std::to_string(depth) + " is not between 1 and " +
                         std::to_string(hal::kMaxStreamDepth));
  auto memory =
      call->add_memory(memory_name(key), Stream::bytes(depth, letters.size()), kStreamAbi);
  if (!memory.ok()) return refuse_stream(memory.error().message());
  fill_in(stream, comp_id, key, Stream::create(*memory, depth, letters));
  return 0;
}

void hal_stream_destroy(hal_stream_t* stream) {
  const Call call;
  if (call.error() != 0 || stream->fifo == nullptr) return;
  static_cast<Stream*>(stream->fifo)->close();
  if (auto status = call->drop_memory(memory_name(stream->shmem_id)); !status.ok())
    (void)refuse(status.error());
  forget(stream);
}

int hal_stream_attach(hal_stream_t* stream, int comp_id, int key, const char* types) {
  const Call call;
  if (call.error() != 0) return call.error();
  if (call->find_component(comp_id) == nullptr)
    return refuse(EINVAL, "component " + std::to_string(comp_id) + " not found");
  const auto found = View(call->segment()).find_memory(memory_name(key));
  if (!found || found->abi != kStreamAbi)
    return refuse_stream("no stream with key " + std::to_string(key));
  const Stream view = Stream::attach(call->segment().base() + found->offset,
                                     static_cast<std::size_t>(found->bytes));
  if (!view.valid()) return refuse_stream("what has key " + std::to_string(key) + " is no stream");
  if (types != nullptr && *types != '\0' && !view.matches(types)) {
    return refuse_stream("the stream has the types '" + std::string(view.types()) + "', not '" +
                         types + "'");
  }
  fill_in(stream, comp_id, key, view);
  return 0;
}

void hal_stream_detach(hal_stream_t* stream) { forget(stream); }

#ifdef ULAPI
void hal_stream_wait_readable(hal_stream_t* stream, sig_atomic_t* stop) {
  while (!hal_stream_readable(stream) && (stop == nullptr || *stop == 0)) wait_a_little();
}
void hal_stream_wait_writable(hal_stream_t* stream, sig_atomic_t* stop) {
  while (!hal_stream_writable(stream) && (stop == nullptr || *stop == 0)) wait_a_little();
}
void hal_port_wait_readable(hal_port_t** port, unsigned count, sig_atomic_t* stop) {
  while (hal_port_readable(*port) < count && (stop == nullptr || *stop == 0)) wait_a_little();
}
void hal_port_wait_writable(hal_port_t** port, unsigned count, sig_atomic_t* stop) {
  while (hal_port_writable(*port) < count && (stop == nullptr || *stop == 0)) wait_a_little();
}
#endif

}  // extern "C"
