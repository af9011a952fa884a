// Registry: memory, and how long it is kept from those who may still use it.
#include <cstring>
#include <new>

#include "hal/core/registry.hpp"
#include "hal/core/registry_change.hpp"

namespace kerf::hal {

using rtapi::Errc;
using rtapi::fail;
using rtapi::Result;
using rtapi::Status;

Result<Offset> Registry::allocate(std::size_t bytes, Region region, Kind kind) {
  Arena& arena = region != Region::structure ? shared_
                 : kind == Kind::function    ? functions_
                                             : structure_;
  auto offset = arena.allocate(bytes);
  if (!offset.ok()) {
    return fail(Errc::no_memory,
                rtapi::format_fixed<480>("HAL memory: %s", offset.error().message().c_str()));
  }
  root_.bytes_used.set(root_.bytes_used.get() + bytes);
  root_.bytes_free.set(structure_.bytes_free() + functions_.bytes_free() + shared_.bytes_free());
  auto& recycled = root_.recycled[static_cast<std::size_t>(kind)];
  if (recycled.get() > 0) recycled.set(recycled.get() - 1);
  return offset;
}

Result<Offset> Registry::take_slot(SlotPool& pool) {
  auto slot = pool.take();
  if (!slot.ok()) {
    return fail(Errc::no_memory,
                rtapi::format_fixed<480>("HAL memory: %s", slot.error().message().c_str()));
  }
  root_.bytes_used.set(root_.bytes_used.get() + SlotPool::kSlotBytes);
  return slot;
}

void Registry::retire(const Block& block) { pending_.push_back(block); }

void Registry::retire_held(const Block& block, Holds least) {
  HeldQueue& queue = least == Holds::own ? held_by_any_ : held_by_all_;
  if (queue.holders.empty())
    retire(block);
  else
    queue.blocks.push_back({block, next_holder_});
}

void Registry::retire_record(Record& record, std::size_t bytes) {
  retire({offset_of(&record), bytes, record.kind, Store::structure});
}

void Registry::give_back(const Block& block) {
  switch (block.store) {
    case Store::structure: {
      Arena& arena = block.kind == Kind::function ? functions_ : structure_;
      arena.give_back(block.offset, block.bytes);
      break;
    }
    case Store::shared: shared_.give_back(block.offset, block.bytes); break;
    case Store::link: links_.give_back(block.offset); break;
    case Store::value: values_.give_back(block.offset); break;
    case Store::signal_value: signal_values_.give_back(block.offset); break;
  }
  root_.bytes_used.set(root_.bytes_used.get() - block.bytes);
  root_.bytes_free.set(structure_.bytes_free() + functions_.bytes_free() + shared_.bytes_free());
  if (block.kind != Kind::none) {
    auto& recycled = root_.recycled[static_cast<std::size_t>(block.kind)];
    recycled.set(recycled.get() + 1);
  }
}

void Registry::reclaim() {
  const auto grace_is_over = [this] {
    for (const auto& seen : snapshot_) {
      if (seen.thread->ticking.get() != 0 && seen.thread->cycles.observe() == seen.cycles)
        return false;
    }
    return true;
  };
  for (HeldQueue* queue : {&held_by_any_, &held_by_all_}) {
    while (!queue->blocks.empty() && !queue->busy(queue->blocks.front())) {
      pending_.push_back(queue->blocks.front().block);
      queue->blocks.pop_front();
    }
  }
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
}

std::uint64_t Registry::add_holder(Holds what) {
  const std::uint64_t holder = next_holder_++;
  held_by_any_.holders.insert(holder);
  if (what == Holds::everything) held_by_all_.holders.insert(holder);
  return holder;
}

void Registry::remove_holder(std::uint64_t holder) {
  held_by_any_.holders.erase(holder);
  held_by_all_.holders.erase(holder);
}

Result<std::byte*> Registry::allocate_memory(std::size_t bytes, Region region) {
  reclaim();
  KERF_TRY(const Offset offset, allocate(bytes, region, Kind::none));
  pieces_[offset] = {bytes, region};
  return segment_.at<std::byte>(offset);
}

void Registry::free_memory(std::byte* memory) {
  const auto it = pieces_.find(offset_of(memory));
  if (it == pieces_.end()) return;
  const auto [bytes, region] = it->second;
  const Offset offset = it->first;
  pieces_.erase(it);
  if (region == Region::shared)
    retire_held({offset, bytes, Kind::none, Store::shared}, Holds::own);
  else
    retire({offset, bytes, Kind::none, Store::structure});
}

Result<MemoryRecord*> Registry::add_memory(std::string_view name, std::size_t bytes,
                                           std::uint64_t abi, bool hidden) {
  KERF_TRY(MemoryRecord * record, make<MemoryRecord>(Kind::memory, name));
  auto memory = allocate(bytes, Region::shared, Kind::none);
  if (!memory.ok()) {
    retire_record(*record, sizeof *record);
    return rtapi::Failure{memory.error()};
  }
  record->memory = *memory;
  record->bytes = bytes;
  record->abi = abi;
  record->hidden = hidden ? 1 : 0;
  const Change change(root_);
  insert(*record);
  return record;
}

void Registry::show_memory(MemoryRecord& memory) {
  const Change change(root_);
  memory.hidden = 0;
}

void Registry::remove_memory(MemoryRecord& memory) {
  const Change change(root_);
  retire_held({memory.memory, memory.bytes, Kind::none, Store::shared}, Holds::own);
  erase(memory, sizeof memory);
}

}  // namespace kerf::hal
