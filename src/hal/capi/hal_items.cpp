// Pins and parameters.
#include <hal.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "hal/capi/hal_lib.hpp"
#include "hal/core/value_text.hpp"

using namespace kerf::hal::capi;  // NOLINT(google-build-using-namespace): the published names
using kerf::hal::Dir;
using kerf::hal::Type;
using kerf::hal::View;
namespace hal = kerf::hal;

namespace {

std::size_t width(Type type) {
  switch (type) {
    case Type::bit: return sizeof(hal_bit_t);
    case Type::s32:
    case Type::u32:
    case Type::port: return 4;
    default: return 8;
  }
}

/// `what` is "pin" or "param". Makes the item, or says why not. `link` gets the place of its link slot.
int add_item(const char* what, int comp_id, NewItem item, int type, int dir,
             kerf::rtapi::Offset* link = nullptr) {
  const bool is_pin = std::strcmp(what, "pin") == 0;
  const std::string call_name = std::string(what) + "_new";
  const Call call;
  if (call.error() != 0) return call.error();
  const char* name = item.name.data();
  item.type = type_of(type);
  if (is_pin && item.type == Type::unspecified) {
    return refuse(EINVAL,
                  "pin type not one of HAL_BIT, HAL_FLOAT, HAL_S32, HAL_U32, HAL_S64, HAL_U64 or "
                  "HAL_PORT");
  }
  if (!is_pin && (item.type == Type::unspecified || item.type == Type::port)) {
    return refuse(EINVAL,
                  "param type not one of HAL_BIT, HAL_FLOAT, HAL_S32, HAL_U32, HAL_S64 or HAL_U64");
  }
  if (is_pin && !hal_pdir_is_pin(static_cast<hal_pdir_t>(dir)))
    return refuse(EINVAL, "pin direction not one of HAL_IN, HAL_OUT, or HAL_IO");
  if (is_pin && item.type == Type::port && dir == HAL_IO)
    return refuse(EINVAL, "pin direction must be one of HAL_IN or HAL_OUT for hal port");
  if (!is_pin && !hal_pdir_is_param(static_cast<hal_pdir_t>(dir)))
    return refuse(EINVAL, "param direction not one of HAL_RO, or HAL_RW");
  item.dir = static_cast<Dir>(dir);
  if (auto bad = bad_name(is_pin ? "pin" : "parameter", name); !bad.empty())
    return refuse(EINVAL, bad);
  if (call.locked(HAL_LOCK_LOAD, call_name.c_str())) return -EPERM;
  Component* component = call.open_component(comp_id, call_name.c_str());
  if (component == nullptr) return -EINVAL;
  if (is_pin && link == nullptr) {
    if (item.cell == nullptr || !call->owns(item.cell, sizeof(void*)))
      return refuse(EINVAL, "data_ptr_addr not in shared memory");
    if (*item.cell != nullptr) {
      return refuse(EINVAL,
                    "pin_new(" + std::string(name) + ") called with already-initialized memory");
    }
  }
  if (!is_pin && link == nullptr &&
      (item.native == nullptr || !call->owns(item.native, width(item.type)))) {
    return refuse(EINVAL, "data_addr not in shared memory");
  }
  auto made = call->add_item(*component, item);
  if (!made.ok()) return refuse(made.error());
  if (link != nullptr) *link = *made;
  return 0;
}

/// The newest kind: a reference is the address of the link slot.
template <class Ref>
int add_reference(const char* what, int comp_id, int type, int dir, Ref* ref, std::uint64_t initial,
                  const std::string& name) {
  if (ref == nullptr)
    return refuse(EINVAL, std::string(what) + " " + quoted(name) + ": no reference");
  kerf::rtapi::Offset link = 0;
  NewItem item;
  item.name = name;
  item.initial = initial;
  const int result = add_item(what, comp_id, item, type, dir, &link);
  if (result < 0) return result;
  const Call call;
  if (call.error() != 0) return call.error();
  *ref = reinterpret_cast<Ref>(call->segment().base() + link);
  return 0;
}

int set_param(const char* name, int type, std::uint64_t raw) {
  const Call call;
  if (call.error() != 0) return call.error();
  if (call.locked(HAL_LOCK_PARAMS, "param_set")) return -EPERM;
  if (name == nullptr) return refuse(EINVAL, "no parameter name");
  const auto param = View(call->segment()).find_param(name);
  if (!param) return refuse(EINVAL, "parameter " + quoted(name) + " not found");
  if (param->type != type_of(type))
    return refuse(EINVAL, "type mismatch setting param " + quoted(name));
  if (param->dir == Dir::ro) return refuse(EINVAL, "param " + quoted(name) + " is not writable");
  char text[40];
  if (param->type == Type::floating)
    std::snprintf(text, sizeof text, "%.17g", hal::from_raw<double>(raw));
  else
    std::snprintf(text, sizeof text, "%s", hal::plain_value_text(param->type, raw).c_str());
  return call.command({"setp", name, text});
}

int set_alias(const char* kind, const char* name, const char* alias) {
  const Call call;
  if (call.error() != 0) return call.error();
  const bool is_pin = std::strcmp(kind, "pin") == 0;
  if (call.locked(HAL_LOCK_CONFIG, is_pin ? "pin_alias" : "param_alias")) return -EPERM;
  if (name == nullptr) return refuse(EINVAL, std::string("no ") + kind + " name");
  const View view(call->segment());
  const auto found = [&](const char* n) { return is_pin ? view.find_pin(n) : view.find_param(n); };
  if (alias != nullptr) {
    if (auto bad = bad_name("alias", alias); !bad.empty()) return refuse(EINVAL, bad);
    if (found(alias)) return refuse(EINVAL, "duplicate pin/alias name " + quoted(alias));
  }
  const auto item = found(name);
  if (!item)
    return refuse(EINVAL, std::string(is_pin ? "pin " : "param ") + quoted(name) + " not found");
  if (alias != nullptr) return call.command({"alias", kind, name, alias});
  if (item->original_name.empty()) return 0;
  return call.command({"unalias", kind, name});
}

template <class T>
std::uint64_t raw_at(const void* p) {
  T value;
  std::memcpy(&value, p, sizeof value);
  return hal::to_raw<T>(value);
}

}  // namespace

extern "C" {

int hal_pin_new(const char* name, hal_type_t type, hal_pdir_t dir, void** data_ptr_addr,
                int comp_id) {
  if (name == nullptr) return refuse(EINVAL, "no pin name");
  NewItem item;
  item.name = name;
  item.cell = data_ptr_addr;
  return add_item("pin", comp_id, item, type, dir);
}

int hal_param_new(const char* name, hal_type_t type, hal_pdir_t dir, void* data_addr, int comp_id) {
  if (name == nullptr) return refuse(EINVAL, "no parameter name");
  NewItem item;
  item.name = name;
  item.native = data_addr;
  return add_item("param", comp_id, item, type, dir);
}

// NOLINTBEGIN(bugprone-macro-parentheses): T pastes names together
#define KERF_PIN_NEW(T, TYPE)                                                                   \
  int hal_pin_##T##_new(const char* name, hal_pdir_t dir, hal_##T##_t** data_ptr_addr,          \
                        int comp_id) {                                                          \
    return hal_pin_new(name, TYPE, dir, static_cast<void**>(static_cast<void*>(data_ptr_addr)), \
                       comp_id);                                                                \
  }                                                                                             \
  int hal_pin_##T##_newf(hal_pdir_t dir, hal_##T##_t** data_ptr_addr, int comp_id,              \
                         const char* fmt, ...) {                                                \
    std::va_list args;                                                                          \
    va_start(args, fmt);                                                                        \
    const std::string name = format_name(fmt, args);                                            \
    va_end(args);                                                                               \
    return hal_pin_##T##_new(name.c_str(), dir, data_ptr_addr, comp_id);                        \
  }
KERF_PIN_NEW(bit, HAL_BIT)
KERF_PIN_NEW(float, HAL_FLOAT)
KERF_PIN_NEW(u32, HAL_U32)
KERF_PIN_NEW(s32, HAL_S32)
KERF_PIN_NEW(u64, HAL_U64)
KERF_PIN_NEW(s64, HAL_S64)
KERF_PIN_NEW(port, HAL_PORT)

#define KERF_PARAM_NEW(T, TYPE)                                                                    \
  int hal_param_##T##_new(const char* name, hal_pdir_t dir, hal_##T##_t* data_addr, int comp_id) { \
    return hal_param_new(name, TYPE, dir,                                                          \
                         const_cast<void*>(static_cast<const volatile void*>(data_addr)),          \
                         comp_id);                                                                 \
  }                                                                                                \
  int hal_param_##T##_newf(hal_pdir_t dir, hal_##T##_t* data_addr, int comp_id, const char* fmt,   \
                           ...) {                                                                  \
    std::va_list args;                                                                             \
    va_start(args, fmt);                                                                           \
    const std::string name = format_name(fmt, args);                                               \
    va_end(args);                                                                                  \
    return hal_param_##T##_new(name.c_str(), dir, data_addr, comp_id);                             \
  }
KERF_PARAM_NEW(bit, HAL_BIT)
KERF_PARAM_NEW(float, HAL_FLOAT)
KERF_PARAM_NEW(u32, HAL_U32)
KERF_PARAM_NEW(s32, HAL_S32)
KERF_PARAM_NEW(u64, HAL_U64)
KERF_PARAM_NEW(s64, HAL_S64)

#define KERF_ITEM_NEW(N, R, V, TYPE)                                                           \
  int hal_pin_new_##N(int comp_id, hal_pdir_t dir, hal_##R##_t* ref, V def, const char* fmt,   \
                      ...) {                                                                   \
    std::va_list args;                                                                         \
    va_start(args, fmt);                                                                       \
    const std::string name = format_name(fmt, args);                                           \
    va_end(args);                                                                              \
    return add_reference("pin", comp_id, TYPE, dir, ref, hal::to_raw<V>(def), name);           \
  }                                                                                            \
  int hal_param_new_##N(int comp_id, hal_pdir_t dir, hal_##R##_t* ref, V def, const char* fmt, \
                        ...) {                                                                 \
    std::va_list args;                                                                         \
    va_start(args, fmt);                                                                       \
    const std::string name = format_name(fmt, args);                                           \
    va_end(args);                                                                              \
    return add_reference("param", comp_id, TYPE, dir, ref, hal::to_raw<V>(def), name);         \
  }
KERF_ITEM_NEW(bool, bool, rtapi_bool, HAL_BIT)
KERF_ITEM_NEW(si32, sint, rtapi_s32, HAL_S32)
KERF_ITEM_NEW(ui32, uint, rtapi_u32, HAL_U32)
KERF_ITEM_NEW(sint, sint, rtapi_sint, HAL_S64)
KERF_ITEM_NEW(uint, uint, rtapi_uint, HAL_U64)
KERF_ITEM_NEW(real, real, rtapi_real, HAL_FLOAT)
// NOLINTEND(bugprone-macro-parentheses)

int hal_pin_new_port(int comp_id, hal_pdir_t dir, hal_sint_t* ref, const char* fmt, ...) {
  std::va_list args;
  va_start(args, fmt);
  const std::string name = format_name(fmt, args);
  va_end(args);
  return add_reference("pin", comp_id, HAL_PORT, dir, ref, 0, name);
}

int hal_param_new_fake(int comp_id, hal_refs_u* ref) {
  const Call call;
  if (call.error() != 0) return call.error();
  if (ref == nullptr || call->find_component(comp_id) == nullptr)
    return refuse(EINVAL, "component " + std::to_string(comp_id) + " not found");
  auto memory = call->allocate(2 * sizeof(std::uint64_t));
  if (!memory.ok()) return refuse(memory.error());
  // A link slot of its own, and the value behind it.
  const std::uint64_t value = call->segment().offset_of(*memory + sizeof(std::uint64_t));
  std::memcpy(*memory, &value, sizeof value);
  ref->b = reinterpret_cast<hal_bool_t>(*memory);
  return 0;
}

int hal_pin_alias(const char* pin_name, const char* alias) {
  return set_alias("pin", pin_name, alias);
}
int hal_param_alias(const char* param_name, const char* alias) {
  return set_alias("param", param_name, alias);
}

int hal_param_bit_set(const char* name, int value) {
  return set_param(name, HAL_BIT, hal::to_raw(value != 0));
}
int hal_param_float_set(const char* name, double value) {
  return set_param(name, HAL_FLOAT, hal::to_raw(value));
}
int hal_param_u32_set(const char* name, unsigned long value) {
  return set_param(name, HAL_U32, hal::to_raw(static_cast<rtapi_u32>(value)));
}
int hal_param_s32_set(const char* name, signed long value) {
  return set_param(name, HAL_S32, hal::to_raw(static_cast<rtapi_s32>(value)));
}
int hal_param_u64_set(const char* name, unsigned long value) {
  return set_param(name, HAL_U64, hal::to_raw(rtapi_u64{value}));
}
int hal_param_s64_set(const char* name, signed long value) {
  return set_param(name, HAL_S64, hal::to_raw(rtapi_s64{value}));
}

int hal_param_set(const char* name, hal_type_t type, void* value_addr) {
  if (value_addr == nullptr) return refuse(EINVAL, "no value");
  switch (type) {
    case HAL_BIT: return set_param(name, type, raw_at<bool>(value_addr));
    case HAL_FLOAT: return set_param(name, type, raw_at<double>(value_addr));
    case HAL_S32: return set_param(name, type, raw_at<std::int32_t>(value_addr));
    case HAL_U32: return set_param(name, type, raw_at<std::uint32_t>(value_addr));
    case HAL_S64: return set_param(name, type, raw_at<std::int64_t>(value_addr));
    case HAL_U64: return set_param(name, type, raw_at<std::uint64_t>(value_addr));
    default: return refuse(EINVAL, "bad type " + std::to_string(static_cast<int>(type)));
  }
}

}  // extern "C"
