// Registry: whether all that it says agrees.
#include <set>
#include <string>

#include "hal/core/port.hpp"
#include "hal/core/registry.hpp"
#include "hal/core/value_access.hpp"

namespace kerf::hal {

using rtapi::Status;

/// Collects the first contradiction.
class Registry::Checker {
 public:
  explicit Checker(const Registry& registry) : r_(registry), root_(registry.root_) {}

  Status run() {
    expect((root_.generation.get() & 1U) == 0, "the generation is odd between changes", nullptr);
    for (std::size_t k = 1; k < kKinds; ++k) list(static_cast<Kind>(k));
    buckets();
    for (const Record* c : lists_[index(Kind::component)])
      component(*static_cast<const ComponentRecord*>(c));
    expect(of_components_ == lists_[index(Kind::pin)].size() + lists_[index(Kind::param)].size(),
           "an item is in no component's chain", nullptr);
    for (const Record* s : lists_[index(Kind::signal)])
      signal(*static_cast<const SignalRecord*>(s));
    for (const Kind kind : {Kind::pin, Kind::param})
      for (const Record* i : lists_[index(kind)]) item(*static_cast<const ItemRecord*>(i));
    expect(linked_ == 0, "a pin is linked to a signal that does not have it in its chain", nullptr);
    for (const Record* o : lists_[index(Kind::original)])
      original(*static_cast<const OriginalRecord*>(o));
    for (const Record* m : lists_[index(Kind::memory)]) {
      const auto& memory = *static_cast<const MemoryRecord*>(m);
      expect(!r_.shared_.is_free(memory.memory, memory.bytes), "its memory is free", m);
    }
    run_lists();
    for (const Arena* arena : {&r_.structure_, &r_.functions_, &r_.shared_})
      if (const char* wrong = arena->wrong(); wrong != nullptr) expect(false, wrong, nullptr);
    if (error_.empty()) return {};
    return rtapi::fail(rtapi::Errc::protocol, error_);
  }

 private:
  static std::size_t index(Kind kind) { return static_cast<std::size_t>(kind); }

  void expect(bool good, const char* text, const Record* record) {
    if (good || !error_.empty()) return;
    error_ = text;
    if (record != nullptr) error_ += ": '" + std::string(record->name.view()) + "'";
  }

  void list(Kind kind) {
    const auto k = index(kind);
    Offset previous = 0;
    std::uint32_t last_id = 0;
    for (auto* r = r_.at<Record>(root_.head[k].get()); r != nullptr;
         r = r_.at<Record>(r->next.get())) {
      expect(r->kind == kind, "a record is in the list of another kind", r);
      expect(r->previous.get() == previous, "a list is not the same backwards", r);
      expect(r->id > last_id, "a list is not in order of creation", r);
      const Arena& arena = kind == Kind::function ? r_.functions_ : r_.structure_;
      expect(!arena.is_free(r_.offset_of(r), sizeof(Record)), "a record is in free memory", r);
      last_id = r->id;
      previous = r_.offset_of(r);
      lists_[k].push_back(r);
      if (lists_[k].size() > root_.count[k].get()) break;
    }
    expect(root_.tail[k].get() == previous, "the tail of a list is wrong", nullptr);
    expect(lists_[k].size() == root_.count[k].get(), "the count of a kind is wrong", nullptr);
  }

  void buckets() {
    std::size_t found = 0;
    std::size_t listed = 0;
    for (const auto& l : lists_) listed += l.size();
    for (std::size_t b = 0; b < Root::kBuckets; ++b) {
      std::set<std::pair<Kind, std::string_view>> names;
      for (auto* r = r_.at<Record>(root_.bucket[b].get()); r != nullptr && found <= listed;
           r = r_.at<Record>(r->hash_next.get())) {
        const Kind kind =
            r->kind == Kind::original ? static_cast<const OriginalRecord*>(r)->of : r->kind;
        expect(bucket_of(kind, r->name) == b, "a record is in the wrong bucket", r);
        expect(names.emplace(kind, r->name.view()).second, "two of a kind have one name", r);
        expect(r->id != 0, "a removed record is in the hash", r);
        ++found;
      }
    }
    expect(found == listed, "lists and hash have different numbers of records", nullptr);
  }

  void component(const ComponentRecord& c) {
    Offset last = 0;
    for (auto* i = r_.at<ItemRecord>(c.first_item.get()); i != nullptr;
         i = r_.at<ItemRecord>(i->owner_next.get())) {
      expect(i->owner == r_.offset_of(&c), "an item is in the chain of another component", i);
      last = r_.offset_of(i);
      if (++of_components_ > lists_[index(Kind::pin)].size() + lists_[index(Kind::param)].size())
        return expect(false, "a component's chain of items loops", &c);
    }
    expect(c.last_item == last, "the end of a component's chain is wrong", &c);
  }

  void signal(const SignalRecord& s) {
    std::uint32_t readers = 0, writers = 0, bidirs = 0;
    Offset previous = 0;
    for (auto* p = r_.at<ItemRecord>(s.first_pin.get()); p != nullptr;
         p = r_.at<ItemRecord>(p->signal_next.get())) {
      expect(p->signal.get() == r_.offset_of(&s), "a pin is in the chain of another signal", p);
      expect(p->signal_previous.get() == previous, "a signal's chain differs backwards", p);
      expect(p->type == s.type, "a pin has another type than its signal", p);
      previous = r_.offset_of(p);
      if (p->dir == Dir::in) ++readers;
      if (p->dir == Dir::out) ++writers;
      if (p->dir == Dir::io) ++bidirs;
      ++linked_;
      if (linked_ > static_cast<std::int64_t>(lists_[index(Kind::pin)].size()))
        return expect(false, "a signal's chain loops", &s);
    }
    expect(readers == s.readers && writers == s.writers && bidirs == s.bidirs,
           "the counts of a signal are wrong", &s);
    expect(writers <= 1, "a signal has two writers", &s);
    expect(writers == 0 || bidirs == 0, "a signal has an output and a bidirectional pin", &s);
    expect(r_.signal_values_.holds(s.value), "a signal's value slot is free", &s);
    expect(slots_.insert(s.value).second, "two share a value slot", &s);
    if (s.type == Type::port) {
      const Offset queue = load_value(Type::port, r_.segment_.at<std::byte>(s.value));
      const auto it = r_.queues_.find(&s);
      expect(queue == (it == r_.queues_.end() ? 0 : it->second.offset),
             "a port's handle leads to no queue of its own", &s);
      expect(queue == 0 || !r_.shared_.is_free(queue, Port::bytes(it->second.bytes)),
             "a port's queue is in free memory", &s);
    }
  }

  void item(const ItemRecord& i) {
    expect(r_.links_.holds(i.link), "a link slot is free", &i);
    expect(slots_.insert(i.link).second, "two share a link slot", &i);
    if (i.native == 0) {
      expect(r_.values_.holds(i.value), "a value slot is free", &i);
      expect(slots_.insert(i.value).second, "two share a value slot", &i);
    }
    const auto* signal = r_.at<SignalRecord>(i.signal.get());
    if (signal != nullptr) --linked_;
    const Offset in_effect = i.link + r_.segment_.at<std::atomic<std::uint64_t>>(i.link)->load(
                                          std::memory_order_relaxed);
    const Offset want = signal != nullptr ? signal->value : i.value;
    expect(in_effect == want, "a link leads to the wrong value", &i);
    if (i.cell != 0) {
      const auto pointer = reinterpret_cast<const std::atomic<std::uint64_t>*>(i.cell)->load(
          std::memory_order_relaxed);
      expect(pointer == i.owner_base + want, "the owner's pointer leads to the wrong value", &i);
    }
    if (const auto* o = r_.at<OriginalRecord>(i.original.get()); o != nullptr)
      expect(o->item == r_.offset_of(&i) && o->of == i.kind, "an alias leads elsewhere", &i);
    expect(r_.find_item(i.kind, i.name) == &i, "an item is not found by its name", &i);
  }

  void original(const OriginalRecord& o) {
    const auto* item = r_.at<ItemRecord>(o.item);
    expect(item != nullptr && item->original.get() == r_.offset_of(&o),
           "an original name belongs to no item", &o);
    expect(r_.find_item(o.of, o.name) == item, "an item is not found by its original name", &o);
  }

  void run_lists() {
    std::multiset<Offset> users;
    for (const Record* t : lists_[index(Kind::thread)]) {
      const auto& thread = *static_cast<const ThreadRecord*>(t);
      const auto* run = r_.at<RunListRecord>(thread.run_list.get());
      const std::uint64_t count = thread.run_count.get();
      if (run == nullptr) {
        expect(count == 0, "a thread without a list runs functions", t);
        continue;
      }
      expect(count <= run->capacity, "a run list is longer than its memory", t);
      for (std::uint64_t i = 0; i < count && i < run->capacity; ++i)
        users.insert(run->functions()[i]);
    }
    for (const Record* f : lists_[index(Kind::function)]) {
      const auto n = users.count(r_.offset_of(f));
      expect(static_cast<const FunctionRecord*>(f)->users == n, "a function's users are wrong", f);
      users.erase(r_.offset_of(f));
    }
    expect(users.empty(), "a thread runs a function that is gone", nullptr);
  }

  const Registry& r_;
  const Root& root_;
  std::vector<const Record*> lists_[kKinds];
  std::set<Offset> slots_;
  std::size_t of_components_{0};
  std::int64_t linked_{0};
  std::string error_;
};

Status Registry::check_invariants() const { return Checker(*this).run(); }

}  // namespace kerf::hal
