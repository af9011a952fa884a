#include "hal/core/registry.hpp"

#include <cstring>
#include <new>

#include "hal/core/registry_change.hpp"

namespace kerf::hal {

using rtapi::Errc;
using rtapi::fail;
using rtapi::Result;
using rtapi::Status;

namespace {

constexpr std::size_t kChunkBytes = 1U << 20U;
constexpr std::size_t kGrain = 64;  // a cache line: two pins of different threads share none

constexpr std::size_t rounded(std::size_t bytes) { return (bytes + kGrain - 1) / kGrain * kGrain; }

std::string quoted(std::string_view s) { return "'" + std::string(s) + "'"; }

const char* kind_name(Kind kind) {
  switch (kind) {
    case Kind::pin: return "pin";
    case Kind::param: return "parameter";
    case Kind::signal: return "signal";
    case Kind::component: return "component";
    case Kind::function: return "function";
    case Kind::thread: return "thread";
    default: return "object";
  }
}

}  // namespace

std::string bad_name_reason(std::string_view name) {
  if (name.empty()) return "a name must not be empty";
  if (name.size() > kNameLength) {
    return "name " + quoted(name) + " is longer than " + std::to_string(kNameLength) +
           " characters";
  }
  for (const char c : name) {
    if (static_cast<unsigned char>(c) <= 0x20 || c == 0x7f) {
      return "name " + quoted(name) + " has a blank or control character";
    }
  }
  return {};
}

Result<std::unique_ptr<Registry>> Registry::create(rtapi::Segment& segment) {
  KERF_TRY(Root * root, segment.make<Root>(Root::kBlock, Root::kAbi));
  return std::unique_ptr<Registry>(new Registry(segment, *root));
}

// ---- memory -------------------------------------------------------------------------------------

Result<Offset> Registry::allocate(std::size_t bytes, Kind kind) {
  bytes = rounded(bytes);
  auto it = free_.find(bytes);
  if (it != free_.end() && !it->second.empty()) {
    const Offset offset = it->second.back();
    it->second.pop_back();
    std::memset(segment_.at<std::byte>(offset), 0, bytes);
    root_.bytes_free.set(root_.bytes_free.get() - bytes);
    root_.bytes_used.set(root_.bytes_used.get() + bytes);
    auto& recycled = root_.recycled[static_cast<std::size_t>(kind)];
    if (recycled.get() > 0) recycled.set(recycled.get() - 1);
    return offset;
  }
  if (chunk_left_ < bytes) {
    const std::size_t size = std::max(bytes, kChunkBytes);
    const auto name = rtapi::format_fixed<40>("hal.%d", chunks_);
    auto block = segment_.make_block(name.c_str(), size, Root::kAbi);
    if (!block.ok()) {
      return fail(Errc::no_memory, rtapi::format_fixed<480>(
                                       "HAL memory is full (%s); give a larger [KERF]SEGMENT_MB",
                                       block.error().message().c_str()));
    }
    ++chunks_;
    chunk_ = *block;
    chunk_left_ = size;
    arena_bytes_ += size;
  }
  std::byte* p = chunk_;
  chunk_ += bytes;
  chunk_left_ -= bytes;
  root_.bytes_used.set(root_.bytes_used.get() + bytes);
  return offset_of(p);
}

void Registry::retire(Offset offset, std::size_t bytes, Kind kind) {
  pending_.push_back({offset, rounded(bytes), kind});
}

void Registry::give_back(const Block& block) {
  free_[block.bytes].push_back(block.offset);
  root_.bytes_used.set(root_.bytes_used.get() - block.bytes);
  root_.bytes_free.set(root_.bytes_free.get() + block.bytes);
  auto& recycled = root_.recycled[static_cast<std::size_t>(block.kind)];
  recycled.set(recycled.get() + 1);
}

bool Registry::user_component_before(std::uint32_t id) const noexcept {
  for (auto* c = at<ComponentRecord>(root_.head[static_cast<std::size_t>(Kind::component)].get());
       c != nullptr; c = at<ComponentRecord>(c->next.get())) {
    if (c->type == ComponentKind::user && c->id < id) return true;
  }
  return false;
}

void Registry::reclaim() {
  const auto grace_is_over = [this] {
    for (const auto& seen : snapshot_) {
      if (seen.thread->ticking.get() != 0 && seen.thread->cycles.observe() == seen.cycles)
        return false;
    }
    return true;
  };
  // Two rounds: what is in grace, and then, with no thread ticking, what was removed since.
  for (int round = 0; round < 2; ++round) {
    if (!in_grace_.empty()) {
      if (!grace_is_over()) break;
      for (const auto& block : in_grace_) give_back(block);
      in_grace_.clear();
    }
    if (pending_.empty()) break;
    in_grace_.swap(pending_);
    snapshot_.clear();
    for (auto* t = at<ThreadRecord>(root_.head[static_cast<std::size_t>(Kind::thread)].get());
         t != nullptr; t = at<ThreadRecord>(t->next.get())) {
      snapshot_.push_back({t, t->cycles.observe()});
    }
  }
  std::erase_if(held_, [this](const HeldBlock& held) {
    if (user_component_before(held.before_id)) return false;
    pending_.push_back(held.block);
    return true;
  });
}

// ---- lists and look-ups -------------------------------------------------------------------------

template <class T>
T* Registry::find(Kind kind, std::string_view name) const noexcept {
  for (auto* r = at<Record>(root_.bucket[bucket_of(kind, name)].get()); r != nullptr;
       r = at<Record>(r->hash_next.get())) {
    if (r->kind == kind && r->name == name) return static_cast<T*>(r);
  }
  return nullptr;
}

ComponentRecord* Registry::find_component(std::string_view name) const noexcept {
  return find<ComponentRecord>(Kind::component, name);
}
ItemRecord* Registry::find_pin(std::string_view name) const noexcept {
  return find<ItemRecord>(Kind::pin, name);
}
ItemRecord* Registry::find_param(std::string_view name) const noexcept {
  return find<ItemRecord>(Kind::param, name);
}
SignalRecord* Registry::find_signal(std::string_view name) const noexcept {
  return find<SignalRecord>(Kind::signal, name);
}
FunctionRecord* Registry::find_function(std::string_view name) const noexcept {
  return find<FunctionRecord>(Kind::function, name);
}
ThreadRecord* Registry::find_thread(std::string_view name) const noexcept {
  return find<ThreadRecord>(Kind::thread, name);
}

std::vector<std::string> Registry::names(Kind kind) const {
  std::vector<std::string> out;
  for (auto* r = at<Record>(root_.head[static_cast<std::size_t>(kind)].get()); r != nullptr;
       r = at<Record>(r->next.get())) {
    out.emplace_back(r->name.view());
  }
  return out;
}

template <class T>
Result<T*> Registry::make(Kind kind, std::string_view name) {
  reclaim();
  if (const auto reason = bad_name_reason(name); !reason.empty())
    return fail(Errc::bad_argument, reason);
  if (find<T>(kind, name) != nullptr) {
    return fail(Errc::exists, std::string("duplicate ") + kind_name(kind) + " " + quoted(name));
  }
  KERF_TRY(const Offset offset, allocate(sizeof(T), kind));
  T* record = new (segment_.at<T>(offset)) T();
  record->kind = kind;
  record->id = next_id_++;
  record->name = Name(name);
  return record;
}

void Registry::insert(Record& record) {
  const auto k = static_cast<std::size_t>(record.kind);
  const Offset self = offset_of(&record);
  const Offset tail = root_.tail[k].get();
  record.previous.set(tail);
  if (tail == 0)
    root_.head[k].publish(self);
  else
    at<Record>(tail)->next.publish(self);
  root_.tail[k].set(self);
  auto& bucket = root_.bucket[bucket_of(record.kind, record.name)];
  record.hash_next.set(bucket.get());
  bucket.publish(self);
  root_.count[k].add(1);
}

void Registry::erase(Record& record, std::size_t bytes) {
  const auto k = static_cast<std::size_t>(record.kind);
  const Offset self = offset_of(&record);
  const Offset next = record.next.get();
  const Offset previous = record.previous.get();
  if (previous == 0)
    root_.head[k].set(next);
  else
    at<Record>(previous)->next.set(next);
  if (next == 0)
    root_.tail[k].set(previous);
  else
    at<Record>(next)->previous.set(previous);
  Word<Offset>* chain = &root_.bucket[bucket_of(record.kind, record.name)];
  while (chain->get() != self) chain = &at<Record>(chain->get())->hash_next;
  chain->set(record.hash_next.get());
  root_.count[k].set(root_.count[k].get() - 1);
  retire(self, bytes, record.kind);
}

// ---- components ---------------------------------------------------------------------------------

Result<ComponentRecord*> Registry::add_component(std::string_view name, ComponentKind kind,
                                                 std::int64_t pid, std::string_view args,
                                                 bool by_loadrt) {
  KERF_TRY(ComponentRecord * c, make<ComponentRecord>(Kind::component, name));
  c->type = kind;
  c->pid = pid;
  c->loaded_by_loadrt = by_loadrt ? 1 : 0;
  if (!args.empty()) {
    auto text = allocate(args.size(), Kind::none);
    if (!text.ok()) {
      retire(offset_of(c), sizeof *c, Kind::component);
      return rtapi::Failure{text.error()};
    }
    std::memcpy(segment_.at<char>(*text), args.data(), args.size());
    c->args = *text;
    c->args_size = static_cast<std::uint32_t>(args.size());
  }
  const Change change(root_);
  insert(*c);
  return c;
}

void Registry::set_ready(ComponentRecord& component) {
  const Change change(root_);
  component.ready = 1;
}

void Registry::remove_component(ComponentRecord& component) {
  const Change change(root_);
  const Offset self = offset_of(&component);
  for (const Kind kind : {Kind::pin, Kind::param}) {
    auto* item = at<ItemRecord>(root_.head[static_cast<std::size_t>(kind)].get());
    while (item != nullptr) {
      auto* next = at<ItemRecord>(item->next.get());
      if (item->owner == self) {
        detach(*item);
        erase(*item, sizeof *item);
      }
      item = next;
    }
  }
  auto* thread = at<ThreadRecord>(root_.head[static_cast<std::size_t>(Kind::thread)].get());
  while (thread != nullptr) {
    auto* next = at<ThreadRecord>(thread->next.get());
    if (thread->owner == self) erase_thread(*thread);
    thread = next;
  }
  auto* function = at<FunctionRecord>(root_.head[static_cast<std::size_t>(Kind::function)].get());
  while (function != nullptr) {
    auto* next = at<FunctionRecord>(function->next.get());
    if (function->owner == self) erase(*function, sizeof *function);
    function = next;
  }
  if (component.args != 0) retire(component.args, component.args_size, Kind::none);
  erase(component, sizeof component);
}

void Registry::erase_thread(ThreadRecord& thread) {
  // A snapshot must not look at a thread that is gone: its cycles are over, which is all the grace there is.
  std::erase_if(snapshot_, [&](const Seen& seen) { return seen.thread == &thread; });
  if (auto* list = at<RunListRecord>(thread.run_list.get()); list != nullptr) {
    for (std::uint64_t i = 0; i < list->count; ++i) {
      if (auto* f = at<FunctionRecord>(list->functions()[i]); f->users > 0) --f->users;
    }
    retire(thread.run_list.get(), sizeof(RunListRecord) + list->count * sizeof(Offset), Kind::none);
  }
  erase(thread, sizeof thread);
}

Result<ItemRecord*> Registry::add_item(Kind kind, ComponentRecord& owner, std::string_view name,
                                       Type type, Dir dir, std::uint64_t initial) {
  KERF_TRY(ItemRecord * item, make<ItemRecord>(kind, name));
  item->type = type;
  item->dir = dir;
  item->owner = offset_of(&owner);
  item->value.store(initial, std::memory_order_relaxed);
  item->link.store(offset_of(&item->value), std::memory_order_relaxed);
  const Change change(root_);
  insert(*item);
  return item;
}

Result<ItemRecord*> Registry::add_pin(ComponentRecord& owner, std::string_view name, Type type,
                                      Dir dir, std::uint64_t initial) {
  if (find_signal(name) != nullptr) {
    return fail(Errc::exists, "pin " + quoted(name) + " would have the name of a signal");
  }
  return add_item(Kind::pin, owner, name, type, dir, initial);
}

Result<ItemRecord*> Registry::add_param(ComponentRecord& owner, std::string_view name, Type type,
                                        Dir dir, std::uint64_t initial) {
  return add_item(Kind::param, owner, name, type, dir, initial);
}

Result<FunctionRecord*> Registry::add_function(ComponentRecord& owner, std::string_view name,
                                               std::uint64_t code, std::uint64_t argument) {
  KERF_TRY(FunctionRecord * f, make<FunctionRecord>(Kind::function, name));
  f->owner = offset_of(&owner);
  f->code = code;
  f->argument = argument;
  const Change change(root_);
  insert(*f);
  return f;
}

Result<ThreadRecord*> Registry::add_thread(ComponentRecord& owner, std::string_view name,
                                           std::int64_t period_ns) {
  KERF_TRY(ThreadRecord * t, make<ThreadRecord>(Kind::thread, name));
  t->period_ns = period_ns;
  t->owner = offset_of(&owner);
  const Change change(root_);
  insert(*t);
  return t;
}

Status Registry::set_run_list(ThreadRecord& thread, std::span<FunctionRecord* const> functions) {
  reclaim();
  KERF_TRY(const Offset offset,
           allocate(sizeof(RunListRecord) + functions.size() * sizeof(Offset), Kind::none));
  auto* list = new (segment_.at<RunListRecord>(offset)) RunListRecord();
  list->count = functions.size();
  for (std::size_t i = 0; i < functions.size(); ++i) list->functions()[i] = offset_of(functions[i]);
  const Change change(root_);
  if (auto* old = at<RunListRecord>(thread.run_list.get()); old != nullptr) {
    for (std::uint64_t i = 0; i < old->count; ++i) {
      if (auto* f = at<FunctionRecord>(old->functions()[i]); f->users > 0) --f->users;
    }
    retire(thread.run_list.get(), sizeof(RunListRecord) + old->count * sizeof(Offset), Kind::none);
  }
  for (auto* f : functions) ++f->users;
  thread.run_list.publish(offset);
  return {};
}

void Registry::set_running(bool on) noexcept {
  root_.running.set(on ? 1 : 0);
  root_.changed.notify();
}

void Registry::set_lock(std::uint32_t bits) noexcept { root_.lock.set(bits); }

Status Registry::check_lock(std::uint32_t bits) const {
  const std::uint32_t locked = root_.lock.get() & bits;
  if (locked == 0) return {};
  const char* what = (locked & lock_load) != 0     ? "loading of components"
                     : (locked & lock_config) != 0 ? "linking and addf"
                     : (locked & lock_params) != 0 ? "setting of values"
                                                   : "starting and stopping";
  return fail(Errc::busy, std::string("HAL is locked: no ") + what + "; 'unlock all' first");
}

}  // namespace kerf::hal
