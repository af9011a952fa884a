// The calls that realtime functions may make. Nothing here allocates, waits or prints.
#include <hal.h>

#include <cstring>

#include "hal/capi/realtime_view.hpp"
#include "hal/component.hpp"
#include "hal/core/port.hpp"
#include "hal/core/records.hpp"
#include "hal/stream.hpp"

namespace kerf::hal::capi {

RealtimeView& realtime_view() noexcept {
  static constinit RealtimeView view;
  return view;
}

}  // namespace kerf::hal::capi

namespace {

using kerf::hal::Port;
using kerf::hal::SlotRef;
using kerf::hal::Stream;
using kerf::hal::capi::realtime_view;

/// A reference is the address of the item's link slot.
template <class Ref>
SlotRef slot_of(Ref ref) noexcept {
  return {kerf::hal::slot_link(reinterpret_cast<std::uint64_t*>(ref))};
}
template <class T, class Ref>
T get(Ref ref) noexcept {
  return ref == nullptr ? T{} : kerf::hal::LinkIo<T>(slot_of(ref)).get();
}
template <class T, class Ref>
T set(Ref ref, T value) noexcept {
  if (ref != nullptr) kerf::hal::LinkIo<T>(slot_of(ref)).set(value);
  return value;
}

Port port_of(const hal_port_t* port) noexcept {
  if (port == nullptr) return {};
  return {realtime_view().base, static_cast<std::uint32_t>(*port)};
}

/// hal_stream_t holds the view that hal_stream_create or hal_stream_attach made.
Stream& stream_of(const hal_stream_t* stream) noexcept {
  return *static_cast<Stream*>(stream->fifo);
}

int level(kerf::hal::Type type) noexcept { return static_cast<int>(type); }

}  // namespace

extern "C" {

// ---- values -------------------------------------------------------------------------------------

rtapi_bool hal_get_bool(const hal_bool_t ref) { return get<bool>(ref); }
rtapi_bool hal_set_bool(hal_bool_t ref, rtapi_bool value) { return set<bool>(ref, value); }
rtapi_s32 hal_get_si32(const hal_sint_t ref) {
  return static_cast<rtapi_s32>(get<std::int64_t>(ref));
}
rtapi_s32 hal_set_si32(hal_sint_t ref, rtapi_s32 value) { return set<std::int32_t>(ref, value); }
rtapi_u32 hal_get_ui32(const hal_uint_t ref) {
  return static_cast<rtapi_u32>(get<std::uint64_t>(ref));
}
rtapi_u32 hal_set_ui32(hal_uint_t ref, rtapi_u32 value) { return set<std::uint32_t>(ref, value); }
rtapi_sint hal_get_sint(const hal_sint_t ref) { return get<std::int64_t>(ref); }
rtapi_sint hal_set_sint(hal_sint_t ref, rtapi_sint value) { return set<std::int64_t>(ref, value); }
rtapi_uint hal_get_uint(const hal_uint_t ref) { return get<std::uint64_t>(ref); }
rtapi_uint hal_set_uint(hal_uint_t ref, rtapi_uint value) { return set<std::uint64_t>(ref, value); }
rtapi_real hal_get_real(const hal_real_t ref) { return get<double>(ref); }
rtapi_real hal_set_real(hal_real_t ref, rtapi_real value) { return set<double>(ref, value); }

rtapi_s32 hal_get_si32_clamped(const hal_sint_t ref) {
  const auto value = get<std::int64_t>(ref);
  if (value > INT32_MAX) return INT32_MAX;
  return value < INT32_MIN ? INT32_MIN : static_cast<rtapi_s32>(value);
}
rtapi_u32 hal_get_ui32_clamped(const hal_uint_t ref) {
  const auto value = get<std::uint64_t>(ref);
  return value > UINT32_MAX ? UINT32_MAX : static_cast<rtapi_u32>(value);
}

rtapi_s64 hal_extend_counter(rtapi_s64 old, rtapi_s64 newlow, int nbits) {
  if (nbits <= 0 || nbits >= 64) return newlow;
  // The difference of the low parts, as a signed number of nbits bits, is how far the counter went.
  const auto shift = static_cast<unsigned>(64 - nbits);
  const auto difference = static_cast<std::uint64_t>(newlow) - static_cast<std::uint64_t>(old);
  const auto step = static_cast<std::int64_t>(difference << shift) >> shift;
  return static_cast<rtapi_s64>(static_cast<std::uint64_t>(old) + static_cast<std::uint64_t>(step));
}

// ---- ports --------------------------------------------------------------------------------------

bool hal_port_read(const hal_port_t* port, char* dest, unsigned count) {
  return port_of(port).read(dest, count);
}
bool hal_port_peek(const hal_port_t* port, char* dest, unsigned count) {
  return port_of(port).peek(dest, count);
}
bool hal_port_peek_commit(const hal_port_t* port, unsigned count) {
  return port_of(port).peek_commit(count);
}
bool hal_port_write(const hal_port_t* port, const char* src, unsigned count) {
  return port_of(port).write(src, count);
}
unsigned hal_port_readable(const hal_port_t* port) { return port_of(port).readable(); }
unsigned hal_port_writable(const hal_port_t* port) { return port_of(port).writable(); }
unsigned hal_port_buffer_size(const hal_port_t* port) { return port_of(port).size(); }
void hal_port_clear(const hal_port_t* port) { port_of(port).clear(); }

// ---- streams ------------------------------------------------------------------------------------

int hal_stream_element_count(hal_stream_t* stream) {
  return static_cast<int>(stream_of(stream).columns());
}
hal_type_t hal_stream_element_type(hal_stream_t* stream, int index) {
  const Stream& s = stream_of(stream);
  if (index < 0 || static_cast<std::size_t>(index) >= s.columns()) return HAL_TYPE_UNINITIALIZED;
  return static_cast<hal_type_t>(level(s.type(static_cast<std::size_t>(index))));
}
int hal_stream_read(hal_stream_t* stream, hal_stream_data_u* row, unsigned* sampleno) {
  Stream& s = stream_of(stream);
  std::uint64_t values[kerf::hal::kStreamColumns];
  std::uint64_t number = 0;
  if (!s.read(values, &number)) return -ENOSPC;
  std::memcpy(row, values, s.columns() * sizeof(std::uint64_t));
  if (sampleno != nullptr) *sampleno = static_cast<unsigned>(number);
  return 0;
}
int hal_stream_write(hal_stream_t* stream, hal_stream_data_u* row) {
  Stream& s = stream_of(stream);
  std::uint64_t values[kerf::hal::kStreamColumns];
  std::memcpy(values, row, s.columns() * sizeof(std::uint64_t));
  for (std::size_t i = 0; i < s.columns(); ++i)
    values[i] = kerf::hal::stream_value(s.type(i), values[i]);
  return s.write(values) ? 0 : -ENOSPC;
}
bool hal_stream_readable(hal_stream_t* stream) { return !stream_of(stream).empty(); }
bool hal_stream_writable(hal_stream_t* stream) { return !stream_of(stream).full(); }
int hal_stream_depth(hal_stream_t* stream) { return static_cast<int>(stream_of(stream).size()); }
unsigned hal_stream_maxdepth(hal_stream_t* stream) { return stream_of(stream).depth(); }
int hal_stream_num_underruns(hal_stream_t* stream) {
  return static_cast<int>(stream_of(stream).underruns());
}
int hal_stream_num_overruns(hal_stream_t* stream) {
  return static_cast<int>(stream_of(stream).overruns());
}

// ---- time and numbers ---------------------------------------------------------------------------

long long rtapi_get_time(void) {
  const auto* clock = realtime_view().clock;
  return clock == nullptr ? 0 : clock->now();
}

long long rtapi_get_clocks(void) {
#if defined(__x86_64__) || defined(__i386__)
  return static_cast<long long>(__builtin_ia32_rdtsc());
#else
  return rtapi_get_time();
#endif
}

long rtapi_delay_max(void) { return 10000; }

void rtapi_delay(long nsec) {
  const auto* clock = realtime_view().clock;
  if (clock == nullptr || clock->is_virtual()) return;
  const auto end = clock->now() + (nsec < rtapi_delay_max() ? nsec : rtapi_delay_max());
  while (clock->now() < end) {
  }
}

long simple_strtol(const char* text, char** end, int base) {
  const char* p = text;
  const bool negative = *p == '-';
  if (*p == '-' || *p == '+') ++p;
  if ((base == 0 || base == 16) && p[0] == '0' && (p[1] == 'x' || p[1] == 'X')) {
    p += 2;
    base = 16;
  } else if (base == 0) {
    base = *p == '0' ? 8 : 10;
  }
  unsigned long value = 0;
  for (;; ++p) {
    int digit = 99;
    if (*p >= '0' && *p <= '9') digit = *p - '0';
    if (*p >= 'a' && *p <= 'z') digit = *p - 'a' + 10;
    if (*p >= 'A' && *p <= 'Z') digit = *p - 'A' + 10;
    if (digit >= base) break;
    value = value * static_cast<unsigned long>(base) + static_cast<unsigned long>(digit);
  }
  if (end != nullptr) *end = const_cast<char*>(p);
  return static_cast<long>(negative ? 0 - value : value);
}

int rtapi_is_kernelspace(void) { return 0; }

}  // extern "C"
