#include "hal/core/registry.hpp"

#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <new>

#include "hal/core/registry_change.hpp"
#include "hal/core/value_access.hpp"
#include "rtapi/base/suggest.hpp"
#include "rtapi/shm/process.hpp"

namespace kerf::hal {

using rtapi::Errc;
using rtapi::fail;
using rtapi::Result;
using rtapi::Status;

namespace {

std::string quoted(std::string_view s) { return "'" + std::string(s) + "'"; }

const char* kind_name(Kind kind) {
  switch (kind) {
    case Kind::pin: return "pin";
    case Kind::param: return "parameter";
    case Kind::signal: return "signal";
    case Kind::component: return "component";
    case Kind::function: return "function";
    case Kind::thread: return "thread";
    case Kind::memory: return "memory";
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
  KERF_TRY(Root * root, segment.make<Root>(Root::kBlock, Root::kAbi, rtapi::Region::structure));
  root->writer_pid = ::getpid();
  root->writer_start = rtapi::process_start_time(::getpid());
  return std::unique_ptr<Registry>(new Registry(segment, *root));
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
ItemRecord* Registry::find_item(Kind kind, std::string_view name) const noexcept {
  for (auto* r = at<Record>(root_.bucket[bucket_of(kind, name)].get()); r != nullptr;
       r = at<Record>(r->hash_next.get())) {
    if (!(r->name == name)) continue;
    if (r->kind == kind) return static_cast<ItemRecord*>(r);
    if (r->kind != Kind::original) continue;
    const auto* original = static_cast<OriginalRecord*>(r);
    if (original->of == kind) return at<ItemRecord>(original->item);
  }
  return nullptr;
}
ItemRecord* Registry::find_pin(std::string_view name) const noexcept {
  return find_item(Kind::pin, name);
}
ItemRecord* Registry::find_param(std::string_view name) const noexcept {
  return find_item(Kind::param, name);
}
MemoryRecord* Registry::find_memory(std::string_view name) const noexcept {
  return find<MemoryRecord>(Kind::memory, name);
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

std::vector<std::string_view> Registry::names(Kind kind) const {
  std::vector<std::string_view> out;
  out.reserve(root_.count[static_cast<std::size_t>(kind)].get());
  for (auto* r = at<Record>(root_.head[static_cast<std::size_t>(kind)].get()); r != nullptr;
       r = at<Record>(r->next.get())) {
    out.push_back(r->name.view());
  }
  return out;
}

std::string Registry::suggestion(std::string_view name, std::initializer_list<Kind> kinds) const {
  std::vector<std::string_view> known;
  for (const Kind kind : kinds) {
    const auto more = names(kind);
    known.insert(known.end(), more.begin(), more.end());
  }
  return rtapi::did_you_mean(name, known);
}

template <class T>
Result<T*> Registry::make(Kind kind, std::string_view name) {
  reclaim();
  if (const auto reason = bad_name_reason(name); !reason.empty())
    return fail(Errc::bad_argument, reason);
  const bool taken = kind == Kind::pin || kind == Kind::param ? find_item(kind, name) != nullptr
                                                              : find<T>(kind, name) != nullptr;
  if (taken) {
    return fail(Errc::exists, std::string("duplicate ") + kind_name(kind) + " " + quoted(name));
  }
  KERF_TRY(const Offset offset, allocate(sizeof(T), Region::structure, kind));
  T* record = new (segment_.at<T>(offset)) T();
  record->kind = kind;
  record->id = next_id_++;
  record->name = Name(name);
  return record;
}

// Defined here for the other files of Registry.
template Result<MemoryRecord*> Registry::make<MemoryRecord>(Kind, std::string_view);
template Result<SignalRecord*> Registry::make<SignalRecord>(Kind, std::string_view);

void Registry::insert_in_hash(Record& record, Kind kind) {
  auto& bucket = root_.bucket[bucket_of(kind, record.name)];
  record.hash_next.set(bucket.get());
  bucket.publish(offset_of(&record));
}

void Registry::erase_from_hash(Record& record, Kind kind) {
  Word<Offset>* chain = &root_.bucket[bucket_of(kind, record.name)];
  while (chain->get() != offset_of(&record)) chain = &at<Record>(chain->get())->hash_next;
  chain->set(record.hash_next.get());
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
  if (record.kind == Kind::original)
    insert_in_hash(record, static_cast<OriginalRecord&>(record).of);
  else
    insert_in_hash(record, record.kind);
  root_.count[k].add(1);
}

void Registry::erase(Record& record, std::size_t bytes) {
  const auto k = static_cast<std::size_t>(record.kind);
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
  if (record.kind == Kind::original)
    erase_from_hash(record, static_cast<OriginalRecord&>(record).of);
  else
    erase_from_hash(record, record.kind);
  root_.count[k].set(root_.count[k].get() - 1);
  record.id = 0;
  retire_record(record, bytes);
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
    auto text = allocate(args.size(), Region::structure, Kind::none);
    if (!text.ok()) {
      retire_record(*c, sizeof *c);
      return rtapi::Failure{text.error()};
    }
    std::memcpy(segment_.at<char>(*text), args.data(), args.size());
    c->args = *text;
    c->args_size = static_cast<std::uint32_t>(args.size());
  }
  if (kind == ComponentKind::user) user_holders_[c] = add_holder();
  const Change change(root_);
  insert(*c);
  return c;
}

void Registry::set_ready(ComponentRecord& component) {
  const Change change(root_);
  component.ready = 1;
}

void Registry::set_unready(ComponentRecord& component) {
  const Change change(root_);
  component.ready = 0;
}

void Registry::remove_component(ComponentRecord& component) {
  const Change change(root_);
  const Offset self = offset_of(&component);
  const bool of_user = component.type != ComponentKind::realtime;
  for (auto* item = at<ItemRecord>(component.first_item.get()); item != nullptr;) {
    auto* next = at<ItemRecord>(item->owner_next.get());
    detach(*item);
    erase_original(*item);
    retire_item(*item, of_user);
    erase(*item, sizeof *item);
    item = next;
  }
  auto* thread = at<ThreadRecord>(root_.head[static_cast<std::size_t>(Kind::thread)].get());
  while (thread != nullptr) {
    auto* next = at<ThreadRecord>(thread->next.get());
    if (thread->owner == self) erase_thread(*thread);
    thread = next;
  }
  for (auto* function = at<FunctionRecord>(component.first_function.get()); function != nullptr;) {
    auto* next = at<FunctionRecord>(function->owner_next.get());
    erase(*function, sizeof *function);
    function = next;
  }
  if (component.args != 0)
    retire({component.args, component.args_size, Kind::none, Store::structure});
  erase(component, sizeof component);
  if (const auto it = user_holders_.find(&component); it != user_holders_.end()) {
    remove_holder(it->second);
    user_holders_.erase(it);
  }
}

void Registry::erase_thread(ThreadRecord& thread) {
  // A snapshot must not look at a thread that is gone: its cycles are over, which is all the grace there is.
  std::erase_if(snapshot_, [&](const Seen& seen) { return seen.thread == &thread; });
  if (const auto* list = at<RunListRecord>(thread.run_list.get()); list != nullptr) {
    for (std::uint64_t i = 0; i < thread.run_count.get(); ++i)
      --at<FunctionRecord>(list->functions()[i])->users;
  }
  retire_run_list(thread);
  erase(thread, sizeof thread);
}

// ---- pins and parameters ------------------------------------------------------------------------

Status Registry::check_spec(const ComponentRecord& owner, const ItemSpec& spec) const {
  const auto reachable = [&](const void* p, std::size_t bytes) {
    const bool own_pointer = p == spec.cell;
    if (own_pointer && owner.type == ComponentKind::realtime) return true;
    if (!segment_.contains(p) || !segment_.in_use(offset_of(p), bytes)) return false;
    if (offset_of(p) % bytes != 0) return false;
    return owner.type == ComponentKind::realtime ||
           offset_of(p) >= segment_.region(Region::shared).begin;
  };
  if (spec.cell != nullptr && !reachable(spec.cell, sizeof *spec.cell)) {
    return fail(Errc::bad_argument,
                "pin " + quoted(spec.name) + ": its pointer must be in memory from hal_malloc");
  }
  if (spec.native != nullptr && !reachable(spec.native, value_bytes(spec.type))) {
    return fail(Errc::bad_argument,
                "parameter " + quoted(spec.name) + ": its value must be in memory from hal_malloc");
  }
  return {};
}

void Registry::point(ItemRecord& pin, Offset slot) noexcept {
  // Release: pairs with the acquire loads of SlotRef and PinCell, so what stands in the slot is there before the slot is used.
  segment_.at<std::atomic<std::uint64_t>>(pin.link)->store(slot - pin.link,
                                                           std::memory_order_release);
  if (pin.cell == 0) return;
  // The same for the owner's pointer; C code reads it as plain memory, which on all our machines is such a load.
  reinterpret_cast<std::atomic<std::uint64_t>*>(pin.cell)->store(pin.owner_base + slot,
                                                                 std::memory_order_release);
}

Result<ItemRecord*> Registry::add_item(Kind kind, ComponentRecord& owner, const ItemSpec& spec) {
  if (spec.type == Type::unspecified)
    return fail(Errc::bad_argument,
                std::string(kind_name(kind)) + " " + quoted(spec.name) + " has no type");
  KERF_CHECK(check_spec(owner, spec));
  KERF_TRY(ItemRecord * item, make<ItemRecord>(kind, spec.name));
  auto link = take_slot(links_);
  auto value = spec.native != nullptr ? Result<Offset>(offset_of(spec.native)) : take_slot(values_);
  if (!link.ok() || !value.ok()) {
    if (link.ok()) retire({*link, SlotPool::kSlotBytes, Kind::none, Store::link});
    if (value.ok() && spec.native == nullptr)
      retire({*value, SlotPool::kSlotBytes, Kind::none, Store::value});
    retire_record(*item, sizeof *item);
    return rtapi::Failure{link.ok() ? value.error() : link.error()};
  }
  item->link = *link;
  item->value = *value;
  item->type = spec.type;
  item->dir = spec.dir;
  item->native = spec.native != nullptr ? 1 : 0;
  item->owner = offset_of(&owner);
  item->cell = std::bit_cast<std::uintptr_t>(spec.cell);
  item->owner_base = spec.owner_base;
  if (spec.native == nullptr) store_slot(segment_.at<std::byte>(*value), spec.initial);
  point(*item, *value);
  const Change change(root_);
  insert(*item);
  if (owner.last_item == 0)
    owner.first_item.set(offset_of(item));
  else
    at<ItemRecord>(owner.last_item)->owner_next.set(offset_of(item));
  owner.last_item = offset_of(item);
  return item;
}

void Registry::retire_item(ItemRecord& item, bool of_user) {
  const Block link{item.link, SlotPool::kSlotBytes, Kind::none, Store::link};
  const Block value{item.value, SlotPool::kSlotBytes, Kind::none, Store::value};
  if (of_user)
    retire_held(link, Holds::own);
  else
    retire(link);
  if (item.native == 0) retire_held(value, of_user ? Holds::own : Holds::everything);
  if (item.type == Type::port) retire_queue(item, of_user ? Holds::own : Holds::everything);
}

Result<ItemRecord*> Registry::add_pin(ComponentRecord& owner, const ItemSpec& spec) {
  if (find_signal(spec.name) != nullptr) {
    return fail(Errc::exists, "pin " + quoted(spec.name) + " would have the name of a signal");
  }
  return add_item(Kind::pin, owner, spec);
}

Result<ItemRecord*> Registry::add_param(ComponentRecord& owner, const ItemSpec& spec) {
  return add_item(Kind::param, owner, spec);
}

Status Registry::alias(Kind kind, std::string_view name, std::string_view alias) {
  reclaim();
  if (alias.size() > kNameLength)
    return fail(Errc::bad_argument, "alias name " + quoted(alias) + " is too long");
  if (const auto reason = bad_name_reason(alias); !reason.empty())
    return fail(Errc::bad_argument, reason);
  if (find_item(kind, alias) != nullptr)
    return fail(Errc::exists, "duplicate pin/alias name " + quoted(alias));
  ItemRecord* item = find_item(kind, name);
  if (item == nullptr) {
    return fail(Errc::not_found, (kind == Kind::pin ? "pin " : "param ") + quoted(name) +
                                     " not found" + suggestion(name, {kind}));
  }
  OriginalRecord* original = nullptr;
  if (item->original.get() == 0) {
    KERF_TRY(const Offset offset,
             allocate(sizeof(OriginalRecord), Region::structure, Kind::original));
    original = new (segment_.at<OriginalRecord>(offset)) OriginalRecord();
    original->kind = Kind::original;
    original->id = next_id_++;
    original->name = item->name;
    original->of = kind;
    original->item = offset_of(item);
  }
  const Change change(root_);
  erase_from_hash(*item, kind);
  if (original != nullptr) {
    insert(*original);
    item->original.set(offset_of(original));
  }
  item->name = Name(alias);
  insert_in_hash(*item, kind);
  return {};
}

Status Registry::unalias(Kind kind, std::string_view name) {
  reclaim();
  ItemRecord* item = find_item(kind, name);
  if (item == nullptr) {
    return fail(Errc::not_found, (kind == Kind::pin ? "pin " : "param ") + quoted(name) +
                                     " not found" + suggestion(name, {kind}));
  }
  if (item->original.get() == 0) return {};
  const Change change(root_);
  erase_from_hash(*item, kind);
  item->name = at<OriginalRecord>(item->original.get())->name;
  erase_original(*item);
  insert_in_hash(*item, kind);
  return {};
}

void Registry::erase_original(ItemRecord& item) {
  if (item.original.get() == 0) return;
  auto& original = *at<OriginalRecord>(item.original.get());
  item.original.set(0);
  erase(original, sizeof original);
}

// ---- functions and threads ----------------------------------------------------------------------

Result<FunctionRecord*> Registry::add_function(ComponentRecord& owner, std::string_view name,
                                               std::uint64_t code, std::uint64_t argument) {
  KERF_TRY(FunctionRecord * f, make<FunctionRecord>(Kind::function, name));
  f->owner = offset_of(&owner);
  f->code = code;
  f->argument = argument;
  const Change change(root_);
  insert(*f);
  if (owner.last_function == 0)
    owner.first_function.set(offset_of(f));
  else
    at<FunctionRecord>(owner.last_function)->owner_next.set(offset_of(f));
  owner.last_function = offset_of(f);
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

void Registry::retire_run_list(ThreadRecord& thread) {
  const auto* list = at<RunListRecord>(thread.run_list.get());
  if (list == nullptr) return;
  retire({offset_of(list), sizeof *list + list->capacity * sizeof(Offset), Kind::none,
          Store::structure});
}

Result<RunListRecord*> Registry::run_list_with_room(ThreadRecord& thread, std::size_t functions) {
  auto* old = at<RunListRecord>(thread.run_list.get());
  if (old != nullptr && functions <= old->capacity) return old;
  const std::size_t capacity = std::bit_ceil(std::max<std::size_t>(functions, 8));
  KERF_TRY(const Offset offset, allocate(sizeof(RunListRecord) + capacity * sizeof(Offset),
                                         Region::structure, Kind::none));
  auto* list = new (segment_.at<RunListRecord>(offset)) RunListRecord();
  list->capacity = capacity;
  const Change change(root_);
  if (old != nullptr)
    std::memcpy(list->functions(), old->functions(), thread.run_count.get() * sizeof(Offset));
  retire_run_list(thread);
  thread.run_list.set(offset);
  return list;
}

Status Registry::set_run_list(ThreadRecord& thread, std::span<FunctionRecord* const> functions) {
  reclaim();
  KERF_TRY(RunListRecord * list, run_list_with_room(thread, functions.size()));
  const Change change(root_);
  for (std::uint64_t i = 0; i < thread.run_count.get(); ++i)
    --at<FunctionRecord>(list->functions()[i])->users;
  for (std::size_t i = 0; i < functions.size(); ++i) {
    list->functions()[i] = offset_of(functions[i]);
    ++functions[i]->users;
  }
  thread.run_count.set(functions.size());
  return {};
}

Status Registry::insert_in_run_list(ThreadRecord& thread, std::size_t index,
                                    FunctionRecord& function) {
  reclaim();
  const std::size_t count = thread.run_count.get();
  if (index > count)
    return fail(Errc::bad_argument, "position behind the end of the thread's list");
  KERF_TRY(RunListRecord * list, run_list_with_room(thread, count + 1));
  const Change change(root_);
  Offset* at_index = list->functions() + index;
  std::memmove(at_index + 1, at_index, (count - index) * sizeof(Offset));
  *at_index = offset_of(&function);
  ++function.users;
  thread.run_count.set(count + 1);
  return {};
}

void Registry::erase_from_run_list(ThreadRecord& thread, std::size_t index) {
  const std::size_t count = thread.run_count.get();
  if (index >= count) return;
  const Change change(root_);
  Offset* at_index = at<RunListRecord>(thread.run_list.get())->functions() + index;
  --at<FunctionRecord>(*at_index)->users;
  std::memmove(at_index, at_index + 1, (count - index - 1) * sizeof(Offset));
  thread.run_count.set(count - 1);
}

void Registry::set_running(bool on) noexcept {
  root_.running.set(on ? 1 : 0);
  root_.changed.notify();
}

void Registry::set_lock(std::uint32_t bits) noexcept { root_.lock.set(bits); }

Status Registry::check_lock(std::uint32_t bits) const {
  const std::uint32_t locked = root_.lock.get() & bits;
  if (locked == 0) return {};
  const char* what = (locked & lock_load) != 0     ? "loading of programs"
                     : (locked & lock_config) != 0 ? "linking and addf"
                     : (locked & lock_params) != 0 ? "setting of values"
                                                   : "starting and stopping";
  return fail(Errc::busy,
              std::string("HAL is locked, ") + what + " is not permitted; 'unlock all' first");
}

}  // namespace kerf::hal
