#include "hal/core/view.hpp"

#include <sched.h>

#include <algorithm>
#include <type_traits>

#include "hal/core/value_access.hpp"
#include "hal/core/value_text.hpp"
#include "rtapi/base/suggest.hpp"
#include "rtapi/clock/real_clock.hpp"

namespace kerf::hal {
namespace {

/// A change takes microseconds, but the writer may be taken off its CPU in the middle of one. Away longer than this, it is dead.
constexpr rtapi::Nanos kPatience = 2 * rtapi::kSecond;
constexpr int kSpins = 200;
/// Chains of a changing structure may loop; no honest one is longer.
constexpr std::size_t kLongest = 1U << 22U;

}  // namespace

const Root* View::root() const {
  if (root_ == nullptr) {
    if (auto found = segment_.find<Root>(Root::kBlock, Root::kAbi); found.ok()) root_ = *found;
  }
  return root_;
}

template <class T>
const T* View::at(Offset offset) const {
  // The offset may be half of a change: it is only trusted to lie in the segment.
  if (offset == 0 || offset % alignof(T) != 0 || !segment_.in_use(offset, sizeof(T)))
    return nullptr;
  return segment_.at<const T>(offset);
}

template <class F>
auto View::consistent(F&& copy) const {
  using Out = std::invoke_result_t<F, const Root&>;
  const Root* r = root();
  if (r == nullptr) return Out{};
  rtapi::Nanos give_up = 0;
  for (int spins = 0;; ++spins) {
    const std::uint64_t before = r->generation.observe();
    if ((before & 1U) == 0) {
      Out out = copy(*r);
      // Acquire: the copy is read before the second look.
      std::atomic_thread_fence(std::memory_order_acquire);
      if (r->generation.get() == before) return out;
    }
    if (spins < kSpins) continue;
    const rtapi::Nanos now = rtapi::monotonic_now();
    if (give_up == 0) give_up = now + kPatience;
    if (now > give_up) break;
    ::sched_yield();
  }
  stuck_ = true;
  return Out{};
}

template <class T, class F>
void View::each(const Root& root, Kind kind, F&& visit) const {
  const T* r = at<T>(root.head[static_cast<std::size_t>(kind)].observe());
  for (std::size_t n = 0; r != nullptr && n < kLongest; ++n) {
    visit(*r);
    r = at<T>(r->next.observe());
  }
}

template <class T>
const T* View::lookup(const Root& root, Kind kind, std::string_view name) const {
  const Record* r = at<Record>(root.bucket[bucket_of(kind, name)].observe());
  for (std::size_t n = 0; r != nullptr && n < kLongest; ++n) {
    if (r->kind == kind && r->name == name) return at<T>(segment_.offset_of(r));
    r = at<Record>(r->hash_next.observe());
  }
  return nullptr;
}

const ItemRecord* View::lookup_item(const Root& root, Kind kind, std::string_view name) const {
  const Record* r = at<Record>(root.bucket[bucket_of(kind, name)].observe());
  for (std::size_t n = 0; r != nullptr && n < kLongest; ++n) {
    if (r->name == name && r->kind == kind) return at<ItemRecord>(segment_.offset_of(r));
    if (r->name == name && r->kind == Kind::original) {
      const auto* original = at<OriginalRecord>(segment_.offset_of(r));
      if (original != nullptr && original->of == kind) return at<ItemRecord>(original->item);
    }
    r = at<Record>(r->hash_next.observe());
  }
  return nullptr;
}

std::uint64_t View::value_at(Type type, Offset offset) const {
  const std::size_t bytes = value_bytes(type);
  if (offset == 0 || offset % bytes != 0 || !segment_.in_use(offset, bytes)) return 0;
  return load_value(type, segment_.at<std::byte>(offset));
}

std::string View::name_at(Offset offset) const {
  const Record* r = at<Record>(offset);
  return r == nullptr ? std::string() : std::string(r->name.view());
}

ItemInfo View::info(const ItemRecord& r) const {
  ItemInfo out;
  out.name = r.name.view();
  out.type = r.type;
  out.dir = r.dir;
  out.original_name = name_at(r.original.get());
  // Acquire: see SlotRef.
  if (const auto* link = at<std::atomic<std::uint64_t>>(r.link); link != nullptr)
    out.raw = value_at(r.type, link->load(std::memory_order_acquire));
  if (const auto* owner = at<ComponentRecord>(r.owner); owner != nullptr) {
    out.owner_id = owner->id;
    out.owner = owner->name.view();
  }
  out.signal = name_at(r.signal.get());
  return out;
}

SignalInfo View::info(const SignalRecord& r) const {
  SignalInfo out;
  out.name = r.name.view();
  out.type = r.type;
  out.raw = value_at(r.type, r.value);
  out.readers = r.readers;
  out.writers = r.writers;
  out.bidirs = r.bidirs;
  const auto* pin = at<ItemRecord>(r.first_pin.get());
  for (std::size_t n = 0; pin != nullptr && n < kLongest; ++n) {
    out.pins.push_back({std::string(pin->name.view()), pin->dir});
    pin = at<ItemRecord>(pin->signal_next.get());
  }
  std::sort(out.pins.begin(), out.pins.end(),
            [](const auto& a, const auto& b) { return a.name < b.name; });
  return out;
}

ComponentInfo View::info(const ComponentRecord& r) const {
  ComponentInfo out;
  out.name = r.name.view();
  out.id = r.id;
  out.type = r.type;
  out.pid = r.pid;
  out.ready = r.ready != 0;
  out.loaded_by_loadrt = r.loaded_by_loadrt != 0;
  if (r.args != 0 && segment_.in_use(r.args, r.args_size))
    out.args.assign(segment_.at<const char>(r.args), r.args_size);
  return out;
}

ThreadInfo View::info(const ThreadRecord& r) const {
  ThreadInfo out;
  out.name = r.name.view();
  out.period_ns = r.period_ns;
  out.cycles = r.cycles.get();
  if (const auto* owner = at<ComponentRecord>(r.owner); owner != nullptr) {
    out.owner_id = owner->id;
    out.owner = owner->name.view();
  }
  if (const auto* list = at<RunListRecord>(r.run_list.observe()); list != nullptr) {
    const std::uint64_t count = r.run_count.get();
    const auto* functions = list->functions();
    if (count <= kLongest && segment_.in_use(segment_.offset_of(functions), count * sizeof(Offset)))
      for (std::uint64_t i = 0; i < count; ++i) out.functions.push_back(name_at(functions[i]));
  }
  return out;
}

std::optional<ItemInfo> View::find(Kind kind, std::string_view name) const {
  return consistent([&](const Root& root) -> std::optional<ItemInfo> {
    const auto* r = lookup_item(root, kind, name);
    if (r == nullptr) return std::nullopt;
    return info(*r);
  });
}

std::optional<ItemInfo> View::find_pin(std::string_view name) const {
  return find(Kind::pin, name);
}
std::optional<ItemInfo> View::find_param(std::string_view name) const {
  return find(Kind::param, name);
}
std::optional<ItemInfo> View::find_item(std::string_view name) const {
  auto item = find(Kind::param, name);
  return item ? item : find(Kind::pin, name);
}

std::optional<SignalInfo> View::find_signal(std::string_view name) const {
  return consistent([&](const Root& root) -> std::optional<SignalInfo> {
    const auto* r = lookup<SignalRecord>(root, Kind::signal, name);
    if (r == nullptr) return std::nullopt;
    return info(*r);
  });
}

std::optional<ComponentInfo> View::find_component(std::string_view name) const {
  return consistent([&](const Root& root) -> std::optional<ComponentInfo> {
    const auto* r = lookup<ComponentRecord>(root, Kind::component, name);
    if (r == nullptr) return std::nullopt;
    return info(*r);
  });
}

std::optional<ThreadInfo> View::find_thread(std::string_view name) const {
  return consistent([&](const Root& root) -> std::optional<ThreadInfo> {
    const auto* r = lookup<ThreadRecord>(root, Kind::thread, name);
    if (r == nullptr) return std::nullopt;
    return info(*r);
  });
}

std::optional<MemoryInfo> View::find_memory(std::string_view name) const {
  return consistent([&](const Root& root) -> std::optional<MemoryInfo> {
    const auto* r = lookup<MemoryRecord>(root, Kind::memory, name);
    if (r == nullptr || !segment_.in_use(r->memory, r->bytes)) return std::nullopt;
    return MemoryInfo{std::string(r->name.view()), r->memory, r->bytes, r->abi};
  });
}

std::vector<MemoryInfo> View::memories() const {
  return consistent([&](const Root& root) {
    std::vector<MemoryInfo> list;
    each<MemoryRecord>(root, Kind::memory, [&](const MemoryRecord& r) {
      list.push_back({std::string(r.name.view()), r.memory, r.bytes, r.abi});
    });
    return list;
  });
}

rtapi::Result<std::byte*> View::block_bytes(const char* name, std::uint64_t abi) const {
  const auto memory = find_memory(name);
  if (!memory) return segment_.find_block(name, abi);
  if (memory->abi != abi) {
    return rtapi::fail(rtapi::Errc::protocol,
                       std::string("memory '") + name + "' was made by another build of Kerf");
  }
  return segment_.base() + memory->offset;
}

namespace {
template <class T>
void sort_by_name(std::vector<T>& items) {
  std::sort(items.begin(), items.end(), [](const T& a, const T& b) { return a.name < b.name; });
}
}  // namespace

std::vector<ItemInfo> View::items(Kind kind) const {
  auto out = consistent([&](const Root& root) {
    std::vector<ItemInfo> list;
    each<ItemRecord>(root, kind, [&](const ItemRecord& r) { list.push_back(info(r)); });
    return list;
  });
  sort_by_name(out);
  return out;
}

std::vector<SignalInfo> View::signals() const {
  auto out = consistent([&](const Root& root) {
    std::vector<SignalInfo> list;
    each<SignalRecord>(root, Kind::signal, [&](const SignalRecord& r) { list.push_back(info(r)); });
    return list;
  });
  sort_by_name(out);
  return out;
}

std::vector<ComponentInfo> View::components() const {
  auto out = consistent([&](const Root& root) {
    std::vector<ComponentInfo> list;
    each<ComponentRecord>(root, Kind::component,
                          [&](const ComponentRecord& r) { list.push_back(info(r)); });
    return list;
  });
  std::reverse(out.begin(), out.end());
  return out;
}

std::vector<ThreadInfo> View::threads() const {
  auto out = consistent([&](const Root& root) {
    std::vector<ThreadInfo> list;
    each<ThreadRecord>(root, Kind::thread, [&](const ThreadRecord& r) { list.push_back(info(r)); });
    return list;
  });
  std::reverse(out.begin(), out.end());
  return out;
}

std::vector<FunctionInfo> View::functions() const {
  auto out = consistent([&](const Root& root) {
    std::vector<FunctionInfo> list;
    each<FunctionRecord>(root, Kind::function, [&](const FunctionRecord& r) {
      FunctionInfo f;
      f.name = r.name.view();
      if (const auto* owner = at<ComponentRecord>(r.owner); owner != nullptr) {
        f.owner_id = owner->id;
        f.owner = owner->name.view();
      }
      f.code = r.code;
      f.argument = r.argument;
      f.users = r.users;
      list.push_back(std::move(f));
    });
    return list;
  });
  sort_by_name(out);
  return out;
}

ThreadTiming View::timing_of(const ThreadRecord& r, std::uint32_t epoch) const {
  ThreadTiming out;
  out.name = r.name.view();
  out.period_ns = r.period_ns;
  out.stats = r.timing.stats(epoch);
  out.wake_up = r.wake_up.stats(epoch);
  if (const auto* list = at<RunListRecord>(r.run_list.observe()); list != nullptr) {
    const std::uint64_t count = r.run_count.get();
    const auto* functions = list->functions();
    if (count > kLongest || !segment_.in_use(segment_.offset_of(functions), count * sizeof(Offset)))
      return out;
    for (std::uint64_t i = 0; i < count; ++i) {
      const auto* function = at<FunctionRecord>(functions[i]);
      if (function == nullptr) break;
      out.functions.push_back({std::string(function->name.view()), function->timing.stats(epoch)});
    }
  }
  Overrun last;
  if (out.stats.overruns == 0 || r.overrun.version() == 0 || !r.overrun.read(last)) return out;
  auto& shown = out.last_overrun.emplace();
  shown.cycle = last.cycle;
  shown.took_ns = last.took_ns;
  shown.woken_late_ns = last.woken_late_ns;
  // The functions may be gone since: then their names are empty.
  const auto* function = at<FunctionRecord>(last.function);
  if (function == nullptr || function->kind != Kind::function) return out;
  shown.function = function->name.view();
  shown.last_function = name_at(last.last_function);
  shown.function_ns = last.function_ns;
  shown.function_usual_ns = last.function_usual_ns;
  shown.function_stats = function->timing.stats(epoch);
  return out;
}

std::vector<ThreadTiming> View::timings() const {
  auto out = consistent([&](const Root& root) {
    std::vector<ThreadTiming> list;
    each<ThreadRecord>(root, Kind::thread, [&](const ThreadRecord& r) {
      list.push_back(timing_of(r, root.timing_epoch.get()));
    });
    return list;
  });
  std::reverse(out.begin(), out.end());
  return out;
}

TimingMode View::timing_mode() const {
  return root() == nullptr ? TimingMode::off : static_cast<TimingMode>(root()->timing_mode.get());
}

std::vector<std::string> View::names(Kind kind) const {
  return consistent([&](const Root& root) {
    std::vector<std::string> list;
    each<Record>(root, kind, [&](const Record& r) { list.emplace_back(r.name.view()); });
    return list;
  });
}

rtapi::Result<std::string> View::value(std::string_view name) const {
  if (const auto item = find_item(name)) return plain_value_text(item->type, item->raw);
  if (const auto signal = find_signal(name)) return plain_value_text(signal->type, signal->raw);
  auto known = names(Kind::pin);
  for (const Kind kind : {Kind::param, Kind::signal}) {
    const auto more = names(kind);
    known.insert(known.end(), more.begin(), more.end());
  }
  return rtapi::fail(rtapi::Errc::not_found, "no pin, parameter or signal '" + std::string(name) +
                                                 "'" + rtapi::did_you_mean(name, known));
}

SlotRef View::slot(std::string_view name) const {
  return consistent([&](const Root& root) -> SlotRef {
    const auto* item = lookup_item(root, Kind::param, name);
    if (item == nullptr) item = lookup_item(root, Kind::pin, name);
    if (item == nullptr || at<std::uint64_t>(item->link) == nullptr) return {};
    return slot_at(segment_, item->link);
  });
}

std::uint32_t View::lock_bits() const { return root() == nullptr ? 0 : root()->lock.get(); }
bool View::running() const { return root() != nullptr && root()->running.get() != 0; }
const rtapi::Cell* View::changed() const { return root() == nullptr ? nullptr : &root()->changed; }

View::Counts View::counts() const {
  Counts out;
  const Root* r = root();
  out.bytes_total = segment_.header().size;
  if (r == nullptr) return out;
  out.bytes_used = r->bytes_used.get();
  out.bytes_free = r->bytes_free.get();
  for (std::size_t k = 0; k < kKinds; ++k) {
    out.active[k] = r->count[k].get();
    out.recycled[k] = r->recycled[k].get();
  }
  return out;
}

}  // namespace kerf::hal
