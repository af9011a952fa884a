// Values by name and the query calls: programs only.
#include <hal.h>

#include <cerrno>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "hal/capi/hal_lib.hpp"
#include "hal/capi/realtime_view.hpp"
#include "hal/core/value_text.hpp"

using namespace kerf::hal::capi;  // NOLINT(google-build-using-namespace): the published names
using kerf::hal::Dir;
using kerf::hal::Type;
using kerf::hal::View;
namespace hal = kerf::hal;

namespace {

hal_query_value_u value_of(Type type, std::uint64_t raw) {
  hal_query_value_u value{};
  switch (type) {
    case Type::bit: value.b = raw != 0; break;
    case Type::floating: value.r = hal::from_raw<double>(raw); break;
    case Type::s32:
    case Type::s64: value.s = hal::from_raw<std::int64_t>(raw); break;
    default: value.u = raw; break;
  }
  return value;
}

/// As setp reads it back, bit by bit.
std::string text_of(Type type, const hal_query_value_u& value) {
  char text[40];
  switch (type) {
    case Type::bit: return value.b ? "1" : "0";
    case Type::floating: std::snprintf(text, sizeof text, "%.17g", value.r); return text;
    case Type::s32:
    case Type::s64: return std::to_string(value.s);
    default: return std::to_string(value.u);
  }
}

/// Signals have no link slot, so each that was asked for gets one of this process's own.
hal_refs_u reference_to_place(hal::Offset place) {
  static std::map<hal::Offset, std::unique_ptr<std::uint64_t>> links;
  auto& link = links[place];
  if (link == nullptr) link = std::make_unique<std::uint64_t>(place);
  hal_refs_u ref{};
  ref.b = reinterpret_cast<hal_bool_t>(link.get());
  return ref;
}

void fill(hal_query_t& q, const hal::ItemInfo& item, bool is_pin, const View& view) {
  q.name = item.original_name.empty() ? item.name.c_str() : item.original_name.c_str();
  q.qtype = is_pin ? HAL_QTYPE_PIN : HAL_QTYPE_PARAM;
  q.pp = {};
  q.pp.type = static_cast<hal_type_t>(item.type);
  q.pp.dir = static_cast<hal_pdir_t>(item.dir);
  q.pp.value = value_of(item.type, item.raw);
  q.pp.alias = item.original_name.empty() ? nullptr : item.name.c_str();
  q.pp.signal = item.signal.empty() ? nullptr : item.signal.c_str();
  q.pp.comp = item.owner.c_str();
  q.pp.comp_id = static_cast<int>(item.owner_id);
  const auto slot = is_pin ? view.pin_slot(item.name) : view.param_slot(item.name);
  q.pp.ref.b = reinterpret_cast<hal_bool_t>(const_cast<void*>(static_cast<const void*>(slot.link)));
}

void fill(hal_query_t& q, const hal::SignalInfo& signal, const View& view) {
  q.name = signal.name.c_str();
  q.qtype = HAL_QTYPE_SIGNAL;
  q.sig = {};
  q.sig.type = static_cast<hal_type_t>(signal.type);
  q.sig.value = value_of(signal.type, signal.raw);
  q.sig.writers = static_cast<int>(signal.writers);
  q.sig.readers = static_cast<int>(signal.readers);
  q.sig.bidirs = static_cast<int>(signal.bidirs);
  if (const auto place = view.signal_place(signal.name); place != 0)
    q.sig.ref = reference_to_place(place);
}

void fill(hal_query_t& q, const hal::ComponentInfo& comp) {
  q.name = comp.name.c_str();
  q.qtype = HAL_QTYPE_COMP;
  q.comp = {};
  q.comp.comp_id = static_cast<int>(comp.id);
  q.comp.type = static_cast<hal_comp_type_t>(comp.type);
  q.comp.pid = static_cast<int>(comp.pid);
  q.comp.ready = comp.ready ? 1 : 0;
  q.comp.insmod = comp.loaded_by_loadrt ? comp.args.c_str() : nullptr;
}

/// The pin or parameter of the query's name, with its text kept by `item`. 0 or -errno.
struct Found {
  std::optional<hal::ItemInfo> item;
  bool is_pin{false};
};
int find_item(const View& view, hal_query_t& q, Found& found) {
  if (q.name == nullptr) return -EINVAL;
  if (q.qtype != HAL_QTYPE_PARAM) {
    found.item = view.find_pin(q.name);
    found.is_pin = found.item.has_value();
  }
  if (!found.item && q.qtype != HAL_QTYPE_PIN) found.item = view.find_param(q.name);
  if (!found.item) return -ENOENT;
  const bool any = q.pp.type == HAL_TYPE_UNINITIALIZED || q.pp.type == HAL_TYPE_UNSPECIFIED;
  return any || type_of(q.pp.type) == found.item->type ? 0 : -EEXIST;
}
int find_signal(const View& view, hal_query_t& q, std::optional<hal::SignalInfo>& found) {
  if (q.name == nullptr) return -EINVAL;
  found = view.find_signal(q.name);
  if (!found) return -ENOENT;
  const bool any = q.sig.type == HAL_TYPE_UNINITIALIZED || q.sig.type == HAL_TYPE_UNSPECIFIED;
  return any || type_of(q.sig.type) == found->type ? 0 : -EEXIST;
}

/// Answers whose texts live only as long as the callback runs: q's own name comes back afterwards.
template <class F>
int answer(hal_query_t* q, hal_query_cb cb, void* arg, F&& fill_in) {
  const char* const name = q->name;
  const auto qtype = q->qtype;
  fill_in(*q);
  const int result = cb != nullptr ? cb(q, arg) : 0;
  q->name = name;
  q->qtype = qtype;
  return result;
}

/// Texts of q that end with this call would dangle: a caller without callback gets the numbers only.
void drop_texts(hal_query_t& q) {
  q.pp.alias = nullptr;
  q.pp.signal = nullptr;
  q.pp.comp = nullptr;
}

int refused(const hal::Reply& reply) {
  switch (static_cast<kerf::rtapi::Errc>(reply.status)) {
    case kerf::rtapi::Errc::busy:
    case kerf::rtapi::Errc::permission: return -EACCES;
    case kerf::rtapi::Errc::not_found: return -ENOENT;
    case kerf::rtapi::Errc::no_memory: return -ENOMEM;
    default: return -EINVAL;
  }
}

template <class Info, class Fill>
int each(const std::vector<Info>& all, hal_query_t* q, hal_query_cb cb, void* arg, Fill&& fill_in) {
  for (const auto& info : all) {
    if (const int result = answer(q, cb, arg, [&](hal_query_t& out) { fill_in(out, info); });
        result != 0) {
      return result;
    }
  }
  return 0;
}

int copy_component(const std::optional<hal::ComponentInfo>& comp, hal_query_t* q) {
  if (!comp) return -ENOENT;
  const char* const name = q->name;
  fill(*q, *comp);
  q->name = name;
  q->comp.insmod = nullptr;
  return 0;
}

}  // namespace

extern "C" {

// ---- by name ------------------------------------------------------------------------------------

int hal_get_pin_value_by_name(const char* name, hal_type_t* type, hal_data_u** data,
                              bool* connected) {
  const Call call;
  if (call.error() != 0) return call.error();
  call->hold_values();
  const View view(call->segment());
  const auto pin = name == nullptr ? std::nullopt : view.find_pin(name);
  if (!pin) return -1;
  const auto slot = view.pin_slot(name);
  if (type != nullptr) *type = static_cast<hal_type_t>(pin->type);
  if (data != nullptr) *data = reinterpret_cast<hal_data_u*>(&slot.slot());
  if (connected != nullptr) *connected = !pin->signal.empty();
  return 0;
}

int hal_get_signal_value_by_name(const char* name, hal_type_t* type, hal_data_u** data,
                                 bool* has_writers) {
  const Call call;
  if (call.error() != 0) return call.error();
  call->hold_values();
  const View view(call->segment());
  const auto signal = name == nullptr ? std::nullopt : view.find_signal(name);
  if (!signal) return -1;
  const auto place = view.signal_place(name);
  if (type != nullptr) *type = static_cast<hal_type_t>(signal->type);
  if (data != nullptr) *data = call->segment().at<hal_data_u>(place);
  if (has_writers != nullptr) *has_writers = signal->writers > 0;
  return 0;
}

int hal_get_param_value_by_name(const char* name, hal_type_t* type, hal_data_u** data) {
  const Call call;
  if (call.error() != 0) return call.error();
  call->hold_values();
  const View view(call->segment());
  const auto param = name == nullptr ? std::nullopt : view.find_param(name);
  if (!param) return -1;
  const auto slot = view.param_slot(name);
  if (type != nullptr) *type = static_cast<hal_type_t>(param->type);
  if (data != nullptr) *data = reinterpret_cast<hal_data_u*>(&slot.slot());
  return 0;
}

// ---- one ----------------------------------------------------------------------------------------

int hal_getref_p(hal_query_t* q) { return hal_get_p(q, nullptr, nullptr); }

int hal_get_p(hal_query_t* q, hal_query_cb cb, void* arg) {
  const Call call;
  if (call.error() != 0) return call.error();
  call->hold_values();
  const View view(call->segment());
  Found found;
  if (const int error = find_item(view, *q, found); error != 0) return error;
  const int result =
      answer(q, cb, arg, [&](hal_query_t& out) { fill(out, *found.item, found.is_pin, view); });
  q->qtype = found.is_pin ? HAL_QTYPE_PIN : HAL_QTYPE_PARAM;
  drop_texts(*q);
  return result;
}

int hal_set_p(hal_query_t* q, hal_query_cb cb, void* arg) {
  const Call call;
  if (call.error() != 0) return call.error();
  const View view(call->segment());
  const auto value = q->pp.value;
  Found found;
  if (const int error = find_item(view, *q, found); error != 0) return error;
  const auto& item = *found.item;
  const bool writable =
      found.is_pin ? item.dir != Dir::out && item.signal.empty() : item.dir == Dir::rw;
  if (!writable) return -EACCES;
  const std::string argv[] = {"setp", q->name, text_of(item.type, value)};
  auto reply = call->command(argv);
  if (!reply.ok()) return refuse(reply.error());
  if (!reply->ok()) return refused(*reply);
  return hal_get_p(q, cb, arg);
}

int hal_getref_s(hal_query_t* q) { return hal_get_s(q, nullptr, nullptr); }

int hal_get_s(hal_query_t* q, hal_query_cb cb, void* arg) {
  const Call call;
  if (call.error() != 0) return call.error();
  call->hold_values();
  const View view(call->segment());
  std::optional<hal::SignalInfo> signal;
  if (const int error = find_signal(view, *q, signal); error != 0) return error;
  const int result = answer(q, cb, arg, [&](hal_query_t& out) { fill(out, *signal, view); });
  q->qtype = HAL_QTYPE_SIGNAL;
  return result;
}

int hal_set_s(hal_query_t* q, hal_query_cb cb, void* arg) {
  const Call call;
  if (call.error() != 0) return call.error();
  const View view(call->segment());
  const auto value = q->sig.value;
  std::optional<hal::SignalInfo> signal;
  if (const int error = find_signal(view, *q, signal); error != 0) return error;
  if (signal->writers > 0 && signal->type != Type::port) return -EACCES;
  const std::string argv[] = {"sets", q->name, text_of(signal->type, value)};
  auto reply = call->command(argv);
  if (!reply.ok()) return refuse(reply.error());
  if (!reply->ok()) return refused(*reply);
  return hal_get_s(q, cb, arg);
}

// ---- many ---------------------------------------------------------------------------------------

int hal_list_p(hal_query_t* q, hal_query_cb cb, void* arg) {
  const Call call;
  if (call.error() != 0) return call.error();
  const View view(call->segment());
  const auto qtype = q->qtype;
  int result = 0;
  if (qtype != HAL_QTYPE_PARAM) {
    result = each(view.pins(), q, cb, arg,
                  [&](hal_query_t& out, const auto& item) { fill(out, item, true, view); });
  }
  if (result == 0 && qtype != HAL_QTYPE_PIN) {
    result = each(view.params(), q, cb, arg,
                  [&](hal_query_t& out, const auto& item) { fill(out, item, false, view); });
  }
  drop_texts(*q);
  return result;
}

int hal_list_p_s(hal_query_t* q, hal_query_cb cb, void* arg) {
  const Call call;
  if (call.error() != 0) return call.error();
  const View view(call->segment());
  if (q->name == nullptr) return -EINVAL;
  const auto signal = view.find_signal(q->name);
  if (!signal) return -ENOENT;
  std::vector<hal::ItemInfo> pins;
  for (const auto& pin : signal->pins) {
    if (auto info = view.find_pin(pin.name); info) pins.push_back(std::move(*info));
  }
  const int result = each(pins, q, cb, arg,
                          [&](hal_query_t& out, const auto& item) { fill(out, item, true, view); });
  drop_texts(*q);
  return result;
}

int hal_list_s(hal_query_t* q, hal_query_cb cb, void* arg) {
  const Call call;
  if (call.error() != 0) return call.error();
  const View view(call->segment());
  return each(view.signals(), q, cb, arg,
              [&](hal_query_t& out, const auto& signal) { fill(out, signal, view); });
}

int hal_list_comp(hal_query_t* q, hal_query_cb cb, void* arg) {
  const Call call;
  if (call.error() != 0) return call.error();
  const int result = each(View(call->segment()).components(), q, cb, arg,
                          [](hal_query_t& out, const auto& comp) { fill(out, comp); });
  q->comp.insmod = nullptr;
  return result;
}

int hal_list_funct(hal_query_t* q, hal_query_cb cb, void* arg) {
  const Call call;
  if (call.error() != 0) return call.error();
  const int result =
      each(View(call->segment()).functions(), q, cb, arg, [](hal_query_t& out, const auto& f) {
        out.name = f.name.c_str();
        out.qtype = HAL_QTYPE_FUNCT;
        out.funct = {};
        out.funct.comp_id = static_cast<int>(f.owner_id);
        out.funct.comp = f.owner.c_str();
        out.funct.users = static_cast<int>(f.users);
        out.funct.reentrant = f.reentrant ? 1 : 0;
        out.funct.funct = reinterpret_cast<hal_funct_t>(f.code);
        out.funct.arg = reinterpret_cast<void*>(f.argument);
      });
  q->funct.comp = nullptr;
  return result;
}

int hal_list_thread(hal_query_t* q, hal_query_cb cb, void* arg) {
  const Call call;
  if (call.error() != 0) return call.error();
  const View view(call->segment());
  std::set<std::string> once;
  for (const auto& f : view.functions())
    if (f.runs_once) once.insert(f.name);
  for (const auto& thread : view.threads()) {
    const auto fill_in = [&](hal_query_t& out) {
      out.name = thread.name.c_str();
      out.qtype = HAL_QTYPE_THREAD;
      out.thread = {};
      out.thread.comp_id = static_cast<int>(thread.owner_id);
      out.thread.comp = thread.owner.c_str();
      out.thread.period = thread.period_ns;
      out.thread.priority = thread.priority;
    };
    if (const int result = answer(q, cb, arg, fill_in); result != 0) return result;
    int index = 0;
    for (const auto& function : thread.functions) {
      const int result = answer(q, cb, arg, [&](hal_query_t& out) {
        fill_in(out);
        out.qtype = HAL_QTYPE_THREAD_FUNCT;
        out.thread.functidx = index++;
        out.thread.is_init = once.count(function) > 0 ? 1 : 0;
        out.thread.funct = function.c_str();
      });
      if (result != 0) return result;
    }
  }
  q->thread.comp = nullptr;
  q->thread.funct = nullptr;
  return 0;
}

int hal_comp_by_name(const char* name, hal_query_t* q) {
  const Call call;
  if (call.error() != 0) return call.error();
  if (name == nullptr) return -EINVAL;
  return copy_component(View(call->segment()).find_component(name), q);
}

int hal_comp_by_id(int comp_id, hal_query_t* q) {
  const Call call;
  if (call.error() != 0) return call.error();
  for (const auto& comp : View(call->segment()).components()) {
    if (static_cast<int>(comp.id) == comp_id) return copy_component(comp, q);
  }
  return -ENOENT;
}

int hal_statistics(hal_statistics_t* statistics) {
  const Call call;
  if (call.error() != 0) return call.error();
  if (statistics == nullptr) return -EINVAL;
  const auto counts = View(call->segment()).counts();
  const auto of = [&](hal::Kind kind) {
    return static_cast<int>(counts.active[static_cast<std::size_t>(kind)]);
  };
  *statistics = {};
  statistics->mem_total = counts.bytes_total;
  statistics->mem_used = counts.bytes_used;
  statistics->mem_free = counts.bytes_free;
  statistics->pins = of(hal::Kind::pin);
  statistics->params = of(hal::Kind::param);
  statistics->signals = of(hal::Kind::signal);
  statistics->comps = of(hal::Kind::component);
  statistics->functs = of(hal::Kind::function);
  statistics->threads = of(hal::Kind::thread);
  return 0;
}

int hal_mutex_force_release(void) { return 0; }
int hal_enforce_exact_base_period(void) { return 0; }
int hal_comp_insmod_args(const char* comp, const char* /*args*/) {
  const Call call;
  if (call.error() != 0) return call.error();
  if (comp == nullptr || !View(call->segment()).find_component(comp)) return -ENOENT;
  return refuse(EINVAL, "component " + quoted(comp) + ": its arguments are what loadrt was given");
}

}  // extern "C"
