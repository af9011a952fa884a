#include "hal/core/view.hpp"

#include <sched.h>

#include <algorithm>
#include <type_traits>
#include <unordered_set>

#include "hal/core/port.hpp"
#include "hal/core/value_access.hpp"
#include "hal/core/value_text.hpp"
#include "rtapi/base/suggest.hpp"
#include "rtapi/clock/real_clock.hpp"
#include "rtapi/shm/process.hpp"
#include "rtapi/sync/patient_read.hpp"

namespace kerf::hal {
namespace {

/// A change takes microseconds, but the writer may be taken off its CPU in the middle of one. Away longer than this, somebody
/// looks whether it lives; longer than kPatience, it is as good as dead.
constexpr rtapi::Nanos kSuspicion = 20 * rtapi::kMillisecond;
constexpr rtapi::Nanos kPatience = 2 * rtapi::kSecond;
constexpr int kSpins = 200;
/// Chains of a changing structure may loop; no honest one is longer.
constexpr std::size_t kLongest = 1U << 22U;

std::string_view name_of(const std::string& name) { return name; }
template <class T>
std::string_view name_of(const T& info) {
  return info.name;
}

/// What was removed and made again while the list was read is in it twice; the later one is there now.
template <class T>
void drop_older_namesakes(std::vector<T>& list) {
  std::unordered_set<std::string_view> later;
  std::vector<bool> old(list.size());
  for (std::size_t i = list.size(); i-- > 0;) old[i] = !later.insert(name_of(list[i])).second;
  later.clear();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (old[i]) continue;
    if (kept != i) list[kept] = std::move(list[i]);
    ++kept;
  }
  list.resize(kept);
}

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

bool View::give_up(const Root& root, Wait& wait) const {
  const rtapi::Nanos now = rtapi::monotonic_now();
  const std::uint64_t generation = root.generation.get();
  if (wait.since == 0 || generation != wait.generation) {
    wait = {now, generation, false};
  } else if ((generation & 1U) != 0 && now - wait.since > kSuspicion) {
    // The same change all the time.
    if (!wait.asked && !rtapi::process_lives(root.writer_pid, root.writer_start)) stuck_ = true;
    wait.asked = true;
    if (now - wait.since > kPatience) stuck_ = true;
  }
  return stuck_;
}

template <class F>
bool View::attempt(const Root& root, F&& copy) const {
  const std::uint64_t before = root.generation.observe();
  if ((before & 1U) != 0) return false;
  copy();
  // Acquire: the copy is read before the second look.
  std::atomic_thread_fence(std::memory_order_acquire);
  return root.generation.get() == before;
}

template <class F>
auto View::consistent(F&& copy) const {
  using Out = std::invoke_result_t<F, const Root&>;
  Out out{};
  const Root* r = root();
  if (r == nullptr) return out;
  Wait wait;
  for (int spins = 1;; ++spins) {
    if (attempt(*r, [&] { out = copy(*r); })) {
      stuck_ = false;
      return out;
    }
    if (spins % kSpins != 0) continue;
    if (give_up(*r, wait)) return Out{};
    ::sched_yield();
  }
}

template <class T, class F>
auto View::list(Kind kind, F&& make) const {
  std::vector<std::invoke_result_t<F, const T&>> out;
  const Root* r = root();
  if (r == nullptr) return out;
  // Where the reading goes on: behind the record with this number, which stands at `last`.
  Offset last = 0;
  std::uint32_t last_id = 0;
  std::size_t piece = largest_piece_;
  std::size_t pieces = 0;
  Wait wait;
  for (int spins = 1;; ++spins) {
    const std::size_t had = out.size();
    const T* next = nullptr;
    Offset read_to = last;
    std::uint32_t read_id = last_id;
    const bool good = attempt(*r, [&] {
      const Record* at_last = at<Record>(last);
      std::size_t hops = 0;
      if (at_last != nullptr && at_last->id == last_id && at_last->kind == kind) {
        next = at<T>(at_last->next.observe());
      } else {
        // It was removed: numbers rise along the list.
        next = at<T>(r->head[static_cast<std::size_t>(kind)].observe());
        for (; next != nullptr && next->id <= last_id && ++hops < kLongest;)
          next = at<T>(next->next.observe());
      }
      for (std::size_t n = 0; next != nullptr && n < piece; ++n) {
        out.push_back(make(*next));
        read_to = segment_.offset_of(next);
        read_id = next->id;
        next = at<T>(next->next.observe());
      }
    });
    if (good) {
      last = read_to;
      last_id = read_id;
      if (next == nullptr) {
        stuck_ = false;
        if (pieces > 0) drop_older_namesakes(out);
        return out;
      }
      ++pieces;
      piece = std::min(piece * 2, largest_piece_);
      wait = {};
      continue;
    }
    // The writer is busy: smaller pieces fit between its changes.
    out.resize(had);
    if ((r->generation.get() & 1U) == 0) piece = std::max<std::size_t>(piece / 4, 1);
    if (spins % kSpins != 0) continue;
    if (give_up(*r, wait)) {
      out.clear();
      return out;
    }
    ::sched_yield();
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
  const std::uint64_t raw = load_value(type, segment_.at<std::byte>(offset));
  if (type != Type::port) return raw;
  const auto* queue = at<PortHeader>(raw);
  return queue == nullptr ? 0 : queue->size;
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
    out.raw = value_at(r.type, r.link + link->load(std::memory_order_acquire));
  if (const auto* owner = at<ComponentRecord>(r.owner); owner != nullptr) {
    out.owner_id = owner->id;
    out.owner = owner->name.view();
  }
  out.signal = name_at(r.signal.get());
  if (r.native == 0) out.place = r.value;
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
  out.priority = r.priority;
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

FunctionInfo View::info(const FunctionRecord& r) const {
  FunctionInfo out;
  out.name = r.name.view();
  if (const auto* owner = at<ComponentRecord>(r.owner); owner != nullptr) {
    out.owner_id = owner->id;
    out.owner = owner->name.view();
  }
  out.code = r.code;
  out.argument = r.argument;
  out.users = r.users;
  out.reentrant = r.reentrant != 0;
  out.runs_once = r.runs_once != 0;
  return out;
}

MemoryInfo View::info(const MemoryRecord& r) const {
  return {std::string(r.name.view()), r.memory, r.bytes, r.abi};
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
    if (r == nullptr || r->hidden != 0 || !segment_.in_use(r->memory, r->bytes))
      return std::nullopt;
    return info(*r);
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
  auto out = list<ItemRecord>(kind, [&](const ItemRecord& r) { return info(r); });
  sort_by_name(out);
  return out;
}

std::vector<SignalInfo> View::signals() const {
  auto out = list<SignalRecord>(Kind::signal, [&](const SignalRecord& r) { return info(r); });
  sort_by_name(out);
  return out;
}

std::vector<ComponentInfo> View::components() const {
  auto out =
      list<ComponentRecord>(Kind::component, [&](const ComponentRecord& r) { return info(r); });
  std::reverse(out.begin(), out.end());
  return out;
}

std::vector<ThreadInfo> View::threads() const {
  auto out = list<ThreadRecord>(Kind::thread, [&](const ThreadRecord& r) { return info(r); });
  std::reverse(out.begin(), out.end());
  return out;
}

std::vector<FunctionInfo> View::functions() const {
  auto out = list<FunctionRecord>(Kind::function, [&](const FunctionRecord& r) { return info(r); });
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
  if (out.stats.overruns == 0 || r.overrun.version() == 0 ||
      !rtapi::read_patiently(r.overrun, last))
    return out;
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
  auto out = list<ThreadRecord>(Kind::thread, [&](const ThreadRecord& r) {
    return timing_of(r, root()->timing_epoch.get());
  });
  std::reverse(out.begin(), out.end());
  return out;
}

TimingMode View::timing_mode() const {
  return root() == nullptr ? TimingMode::off : static_cast<TimingMode>(root()->timing_mode.get());
}

std::vector<MemoryInfo> View::memories() const {
  return list<MemoryRecord>(Kind::memory, [&](const MemoryRecord& r) { return info(r); });
}

std::vector<std::string> View::names(Kind kind) const {
  return list<Record>(kind, [](const Record& r) { return std::string(r.name.view()); });
}

rtapi::Status View::health() const {
  if (root() == nullptr) return rtapi::fail(rtapi::Errc::not_found, "HAL does not run");
  if (!stuck_) (void)consistent([](const Root&) { return true; });
  if (!stuck_) return {};
  return rtapi::fail(rtapi::Errc::dead,
                     "the realtime host died in the middle of a change of HAL; `halrun -U` clears "
                     "up what is left");
}

rtapi::Result<std::string> View::value(std::string_view name) const {
  if (const auto item = find_item(name)) return plain_value_text(item->type, item->raw);
  if (const auto signal = find_signal(name)) return plain_value_text(signal->type, signal->raw);
  if (stuck_) return rtapi::Failure{health().error()};
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

SlotRef View::slot(Kind kind, std::string_view name) const {
  return consistent([&](const Root& root) -> SlotRef {
    const auto* item = lookup_item(root, kind, name);
    if (item == nullptr || at<std::uint64_t>(item->link) == nullptr) return {};
    return slot_at(segment_, item->link);
  });
}

Offset View::signal_place(std::string_view name) const {
  return consistent([&](const Root& root) -> Offset {
    const auto* signal = lookup<SignalRecord>(root, Kind::signal, name);
    return signal == nullptr ? 0 : signal->value;
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
