// Registry against a simple model: random changes, allowed and not; after them both say the same, the registry does not contradict
// itself, and no memory is given out while somebody may still use it.
#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>

#include "hal/core/port.hpp"
#include "hal/core/value_access.hpp"
#include "hal/core/view.hpp"
#include "property/hal/registry_model.hpp"

namespace kerf::hal::test {
namespace {

unsigned machines = 60;
unsigned only_seed = 0;

class RegistryProperty {
 public:
  explicit RegistryProperty(unsigned seed) : r_(seed) {}

  void run(int steps) {
    for (int step = 0; step < steps && !testing::Test::HasFailure(); ++step) {
      SCOPED_TRACE("step " + std::to_string(step));
      change();
      if (step % 20 == 0) check();
    }
    check();
  }

 private:
  using Region = rtapi::Region;

  std::string pin_name() {
    // Now and then the name of something else.
    if (r_.chance(0.1)) return "a" + std::to_string(r_.integer(0, 19));
    if (r_.chance(0.05)) return "s" + std::to_string(r_.integer(0, 14));
    return "p" + std::to_string(r_.integer(0, 39));
  }
  std::string known_pin() {
    auto& pins = m_.items[0];
    if (pins.empty() || r_.chance(0.05)) return pin_name();
    const auto& [original, item] = r_.pick(pins);
    return r_.chance(0.5) ? item.shown() : original;
  }
  std::string signal_name() {
    return r_.chance(0.05) ? pin_name() : "s" + std::to_string(r_.integer(0, 14));
  }
  Type type() { return r_.pick(types_); }
  std::uint64_t random_value(Type type) {
    switch (type) {
      case Type::bit: return to_raw(r_.chance(0.5));
      case Type::floating: return to_raw(r_.integer(-1000, 1000) / 8.0);
      case Type::s32: return to_raw(std::int32_t{r_.integer(INT32_MIN, INT32_MAX)});
      case Type::u32: return to_raw(static_cast<std::uint32_t>(r_.integer(INT32_MIN, INT32_MAX)));
      case Type::port: return 0;
      default: return to_raw(static_cast<std::int64_t>(r_.integer(INT32_MIN, INT32_MAX)) << 20);
    }
  }
  static bool ok(const rtapi::Status& status) { return status.ok(); }
  void agree(bool allowed, const rtapi::Status& status, const std::string& what) {
    EXPECT_EQ(status.ok(), allowed)
        << what << ": " << (status.ok() ? "" : status.error().message());
  }
  void fresh(const std::string& what, Offset offset, std::size_t bytes) {
    EXPECT_EQ(m_.given(offset, bytes), "") << "was given to " << what << " too early";
  }

  void change() {
    switch (r_.integer(0, 29)) {
      case 0: return add_component();
      case 1: return r_.chance(0.3) ? remove_component() : void();
      case 2: return ready();
      case 3:
      case 4:
      case 5: return add_item(Kind::pin);
      case 6: return add_item(Kind::param);
      case 7: return alias();
      case 8: return unalias();
      case 9: return new_signal();
      case 10: return delete_signal();
      case 11:
      case 12:
      case 13: return net();
      case 14:
      case 15: return link();
      case 16: return link_pins();
      case 17: return unlink();
      case 18: return set_item();
      case 19: return set_signal();
      case 20: return write();
      case 21: return add_function();
      case 22: return add_thread();
      case 23:
      case 24: return run_list();
      case 25: return tick();
      case 26: return holders();
      case 27: return named_memory();
      case 28: return pieces();
      default: registry_->reclaim();
    }
  }

  // ---- components, pins, parameters

  void add_component() {
    const std::string name = "c" + std::to_string(r_.integer(0, 7));
    const bool user = r_.chance(0.4);
    auto made = registry_->add_component(name, user ? ComponentKind::user : ComponentKind::realtime,
                                         1, "some arguments");
    EXPECT_EQ(made.ok(), m_.components.count(name) == 0);
    if (!made.ok()) return;
    ModelComponent c;
    c.user = user;
    if (user) m_.holders[c.holder = m_.next_holder++] = false;
    m_.components[name] = c;
  }

  void remove_component() {
    if (m_.components.empty()) return;
    const std::string name = r_.pick(m_.components).first;
    // Functions must not run any more.
    for (auto& [t, thread] : m_.threads) {
      std::vector<std::string> rest;
      for (const auto& f : thread.functions)
        if (m_.functions.at(f) != name) rest.push_back(f);
      if (rest.size() != thread.functions.size()) set_run_list(t, rest);
    }
    for (auto& items : m_.items) {
      for (auto it = items.begin(); it != items.end();) {
        ModelItem& item = it->second;
        if (item.component != name) {
          ++it;
          continue;
        }
        auto* record = find(item);
        const bool user = m_.components.at(name).user;
        m_.detach(item);
        m_.forbid("link of " + item.original, record->link, 8, user, false);
        if (!item.native) m_.forbid("value of " + item.original, record->value, 8, user);
        m_.forbid("record of " + item.original, segment_->offset_of(record), sizeof *record, false,
                  false);
        forbid_queue(record, item.original, user);
        it = items.erase(it);
      }
    }
    std::erase_if(m_.threads, [&](const auto& t) { return t.second.component == name; });
    std::erase_if(m_.functions, [&](const auto& f) { return f.second == name; });
    registry_->remove_component(*registry_->find_component(name));
    if (m_.components.at(name).user) m_.holders.erase(m_.components.at(name).holder);
    m_.components.erase(name);
  }

  void forbid_queue(const Record* record, const std::string& name, bool by_holders) {
    const auto it = queues_.find(record);
    if (it == queues_.end()) return;
    m_.forbid("queue of " + name, it->second.first, Port::bytes(it->second.second), by_holders);
    queues_.erase(it);
  }

  void ready() {
    if (m_.components.empty()) return;
    auto& [name, c] = r_.pick(m_.components);
    c.ready = !c.ready;
    auto& record = *registry_->find_component(name);
    c.ready ? registry_->set_ready(record) : registry_->set_unready(record);
  }

  void add_item(Kind kind) {
    if (m_.components.empty()) return;
    const auto& [owner, c] = r_.pick(m_.components);
    ModelItem item;
    item.kind = kind;
    item.original = pin_name();
    item.component = owner;
    item.type = kind == Kind::param ? r_.pick(param_types_) : type();
    item.value = random_value(item.type);
    ItemSpec spec{.name = item.original, .type = item.type, .initial = item.value};
    if (kind == Kind::pin) {
      item.dir = r_.pick(pin_dirs_);
      if (r_.chance(0.4)) {
        item.cell = &cells(c.user)[next_cell_++ % kCells];
        spec.cell = item.cell;
        spec.owner_base = 0x5000'0000;
      }
    } else {
      item.dir = r_.chance(0.5) ? Dir::rw : Dir::ro;
      if (r_.chance(0.4)) {
        item.native = true;
        spec.native = &cells(c.user)[next_cell_++ % kCells];
        store_value(item.type, spec.native, item.value);
      }
    }
    spec.dir = item.dir;
    auto& record = *registry_->find_component(owner);
    auto made =
        kind == Kind::pin ? registry_->add_pin(record, spec) : registry_->add_param(record, spec);
    const bool allowed = m_.find(kind, item.original) == nullptr &&
                         (kind == Kind::param || m_.signals.count(item.original) == 0);
    EXPECT_EQ(made.ok(), allowed) << item.original;
    if (!made.ok()) return;
    fresh("link of " + item.original, (*made)->link, 8);
    fresh("record of " + item.original, segment_->offset_of(*made), sizeof(ItemRecord));
    if (!item.native) fresh("value of " + item.original, (*made)->value, 8);
    m_.items[Model::index(kind)][item.original] = item;
  }

  ItemRecord* find(const ModelItem& item) {
    return item.kind == Kind::pin ? registry_->find_pin(item.original)
                                  : registry_->find_param(item.original);
  }

  void alias() {
    const Kind kind = r_.chance(0.8) ? Kind::pin : Kind::param;
    const std::string name = r_.chance(0.8) ? known_pin() : pin_name();
    const std::string alias = r_.chance(0.7) ? "a" + std::to_string(r_.integer(0, 19)) : pin_name();
    ModelItem* item = m_.find(kind, name);
    const bool allowed = item != nullptr && m_.find(kind, alias) == nullptr;
    agree(allowed, registry_->alias(kind, name, alias), "alias " + name + " " + alias);
    if (allowed) item->alias = alias;
  }

  void unalias() {
    const Kind kind = r_.chance(0.8) ? Kind::pin : Kind::param;
    const std::string name = known_pin();
    ModelItem* item = m_.find(kind, name);
    agree(item != nullptr, registry_->unalias(kind, name), "unalias " + name);
    if (item != nullptr) item->alias.clear();
  }

  // ---- signals

  void new_signal() {
    const std::string name = signal_name();
    const Type t = type();
    const bool allowed = m_.signals.count(name) == 0 && m_.pin(name) == nullptr;
    agree(allowed, registry_->new_signal(name, t), "newsig " + name);
    if (allowed) made_signal(name, t);
  }
  void made_signal(const std::string& name, Type t) {
    m_.signals[name].type = t;
    const auto* record = registry_->find_signal(name);
    ASSERT_NE(record, nullptr);
    fresh("value of " + name, record->value, 8);
    fresh("record of " + name, segment_->offset_of(record), sizeof *record);
  }

  void delete_signal() {
    const std::string name = signal_name();
    const auto it = m_.signals.find(name);
    const auto* record = registry_->find_signal(name);
    if (it != m_.signals.end()) {
      m_.forbid("value of " + name, record->value, 8, it->second.seen);
      m_.forbid("record of " + name, segment_->offset_of(record), sizeof *record, false, false);
      forbid_queue(record, name, it->second.seen);
      const auto pins = it->second.pins;
      for (const auto& pin : pins) m_.detach(m_.items[0].at(pin));
      m_.signals.erase(it);
      EXPECT_TRUE(ok(registry_->delete_signal(name)));
    } else {
      EXPECT_FALSE(ok(registry_->delete_signal(name)));
    }
  }

  void attach(ModelItem& pin, const std::string& signal) {
    forbid_queue(find(pin), pin.original, m_.is_user(pin));
    m_.attach(pin, signal);
  }

  void net() {
    const std::string name = signal_name();
    std::vector<std::string> pins;
    for (int i = r_.integer(0, 4); i > 0; --i) pins.push_back(known_pin());
    const auto signal = m_.signals.find(name);
    const bool exists = signal != m_.signals.end();
    bool allowed = !pins.empty() && m_.pin(name) == nullptr;
    int outs = exists ? m_.count(signal->second, Dir::out) : 0;
    int ios = exists ? m_.count(signal->second, Dir::io) : 0;
    Type t = exists ? signal->second.type : Type::unspecified;
    std::vector<ModelItem*> added;
    for (const auto& p : pins) {
      ModelItem* pin = m_.pin(p);
      if (pin == nullptr) {
        allowed = false;
        break;
      }
      if (std::find(added.begin(), added.end(), pin) != added.end()) continue;
      if (!pin->signal.empty()) {
        if (pin->signal == name) continue;
        allowed = false;
        break;
      }
      if (t == Type::unspecified) t = pin->type;
      if (t != pin->type || !Model::fits(pin->dir, outs, ios)) {
        allowed = false;
        break;
      }
      if (pin->dir == Dir::out) ++outs;
      if (pin->dir == Dir::io) ++ios;
      added.push_back(pin);
    }
    agree(allowed, registry_->net(name, pins), "net " + name);
    if (!allowed) return;
    if (!exists) made_signal(name, t);
    for (auto* pin : added) attach(*pin, name);
  }

  void link() {
    const std::string p = known_pin();
    const std::string s = signal_name();
    ModelItem* pin = m_.pin(p);
    const auto signal = m_.signals.find(s);
    bool allowed = pin != nullptr && signal != m_.signals.end();
    if (allowed && !pin->signal.empty()) {
      agree(pin->signal == s, registry_->link(p, s), "linked already");
      return;
    }
    allowed = allowed && pin->type == signal->second.type &&
              Model::fits(pin->dir, m_.count(signal->second, Dir::out),
                          m_.count(signal->second, Dir::io));
    agree(allowed, registry_->link(p, s), "linkps " + p + " " + s);
    if (allowed) attach(*pin, s);
  }

  void link_pins() {
    const std::string first = known_pin();
    const std::string second = known_pin();
    ModelItem* a = m_.pin(first);
    ModelItem* b = m_.pin(second);
    bool allowed = a != nullptr && b != nullptr && a->signal.empty() && b->signal.empty() &&
                   a->type == b->type && m_.signals.count(first) == 0;
    if (allowed && a != b && a->dir != Dir::in && b->dir != Dir::in)
      allowed = a->dir != Dir::out && b->dir != Dir::out;
    agree(allowed, registry_->link_pins(first, second), "linkpp " + first + " " + second);
    if (!allowed) return;
    made_signal(first, a->type);
    attach(*a, first);
    if (a != b) attach(*b, first);
  }

  void unlink() {
    const std::string name = known_pin();
    ModelItem* pin = m_.pin(name);
    agree(pin != nullptr, registry_->unlink(name), "unlinkp " + name);
    if (pin != nullptr) m_.detach(*pin);
  }

  // ---- values

  void set_item() {
    const std::string name = known_pin();
    ModelItem* param = m_.find(Kind::param, name);
    ModelItem* item = param != nullptr ? param : m_.pin(name);
    bool allowed =
        item != nullptr &&
        (param != nullptr ? param->dir == Dir::rw : item->dir != Dir::out && item->signal.empty());
    if (item != nullptr && item->type == Type::port) {
      const auto* record = find(*item);
      const int bytes = r_.integer(1, 300);
      allowed = allowed && queues_.count(record) == 0;
      agree(allowed, registry_->set_item(name, std::to_string(bytes)), "setp of a port");
      if (allowed) made_queue(record, record->value, static_cast<std::uint32_t>(bytes));
      return;
    }
    const std::uint64_t value = item == nullptr ? 0 : random_value(item->type);
    agree(allowed, registry_->set_item(name, item == nullptr ? "1" : text(item->type, value)),
          "setp " + name);
    if (allowed) item->value = value;
  }

  static std::string text(Type type, std::uint64_t raw) {
    if (type == Type::floating) return std::to_string(from_raw<double>(raw));
    if (type == Type::s32 || type == Type::s64) return std::to_string(from_raw<std::int64_t>(raw));
    return std::to_string(raw);
  }

  void made_queue(const Record* record, Offset value, std::uint32_t bytes) {
    const Offset queue = load_value(Type::port, segment_->at<std::byte>(value));
    ASSERT_NE(queue, 0U);
    fresh("queue of a port", queue, Port::bytes(bytes));
    queues_[record] = {queue, bytes};
  }

  void set_signal() {
    const std::string name = signal_name();
    const auto it = m_.signals.find(name);
    if (it != m_.signals.end() && it->second.type == Type::port) {
      const auto* record = registry_->find_signal(name);
      const int bytes = r_.integer(1, 300);
      const bool allowed = queues_.count(record) == 0;
      agree(allowed, registry_->set_signal(name, std::to_string(bytes)), "sets of a port");
      if (allowed) made_queue(record, record->value, static_cast<std::uint32_t>(bytes));
      return;
    }
    const bool allowed = it != m_.signals.end() && m_.count(it->second, Dir::out) == 0;
    const std::uint64_t value = allowed ? random_value(it->second.type) : 0;
    agree(allowed, registry_->set_signal(name, allowed ? text(it->second.type, value) : "1"),
          "sets " + name);
    if (allowed) it->second.value = value;
  }

  /// As the component writes: through its handle, or the pointer that it was given.
  void write() {
    if (m_.items[0].empty()) return;
    auto& item = r_.pick(m_.items[0]).second;
    if (item.type == Type::port) return;
    const std::uint64_t value = random_value(item.type);
    if (item.cell != nullptr)
      store_value(item.type, segment_->at<std::byte>(*item.cell - 0x5000'0000), value);
    else
      registry_->slot_ref(*find(item)).slot().store(value);
    m_.value_of(item) = value;
  }

  // ---- functions, threads

  void add_function() {
    if (m_.components.empty()) return;
    const std::string owner = r_.pick(m_.components).first;
    const std::string name = "f" + std::to_string(r_.integer(0, 29));
    auto made = registry_->add_function(*registry_->find_component(owner), name, 0, 0);
    EXPECT_EQ(made.ok(), m_.functions.count(name) == 0);
    if (made.ok()) m_.functions[name] = owner;
  }

  void add_thread() {
    if (m_.components.empty()) return;
    const std::string owner = r_.pick(m_.components).first;
    const std::string name = "t" + std::to_string(r_.integer(0, 2));
    auto made = registry_->add_thread(*registry_->find_component(owner), name, 1'000'000);
    EXPECT_EQ(made.ok(), m_.threads.count(name) == 0);
    if (!made.ok()) return;
    ModelThread& t = m_.threads[name];
    t.component = owner;
    t.number = ++threads_made_;
  }

  void set_run_list(const std::string& name, const std::vector<std::string>& functions) {
    std::vector<FunctionRecord*> records;
    for (const auto& f : functions) records.push_back(registry_->find_function(f));
    EXPECT_TRUE(ok(registry_->set_run_list(*registry_->find_thread(name), records)));
    m_.threads.at(name).functions = functions;
  }

  void run_list() {
    if (m_.threads.empty() || m_.functions.empty()) return;
    auto& [name, thread] = r_.pick(m_.threads);
    auto& list = thread.functions;
    auto& record = *registry_->find_thread(name);
    const int at = r_.integer(0, static_cast<int>(list.size()));
    if (r_.chance(0.1)) {
      auto other = list;
      std::reverse(other.begin(), other.end());
      set_run_list(name, other);
    } else if (r_.chance(0.7)) {
      const std::string function = r_.pick(m_.functions).first;
      EXPECT_TRUE(ok(registry_->insert_in_run_list(record, static_cast<std::size_t>(at),
                                                   *registry_->find_function(function))));
      list.insert(list.begin() + at, function);
    } else if (static_cast<std::size_t>(at) < list.size()) {
      registry_->erase_from_run_list(record, static_cast<std::size_t>(at));
      list.erase(list.begin() + at);
    }
  }

  void tick() {
    if (m_.threads.empty()) return;
    auto& [name, thread] = r_.pick(m_.threads);
    auto& record = *registry_->find_thread(name);
    if (r_.chance(0.3)) {
      thread.ticking = !thread.ticking;
      record.ticking.publish(thread.ticking ? 1 : 0);
      if (thread.ticking) return;
      // A thread that rests uses nothing.
      for (auto& f : m_.forbidden) f.cycles.erase(thread.number);
    } else {
      record.cycles.publish(++thread.cycles);
    }
  }

  // ---- memory

  void holders() {
    if (r_.chance(0.5) && own_holders_.size() < 4) {
      const bool everything = r_.chance(0.3);
      const auto holder = registry_->add_holder(everything ? Holds::everything : Holds::own);
      const auto number = m_.next_holder++;
      m_.holders[number] = everything;
      own_holders_[holder] = number;
    } else if (!own_holders_.empty()) {
      const auto [holder, number] = r_.pick(own_holders_);
      registry_->remove_holder(holder);
      own_holders_.erase(holder);
      m_.holders.erase(number);
    }
  }

  void named_memory() {
    const std::string name = "m" + std::to_string(r_.integer(0, 5));
    if (r_.chance(0.5)) {
      const auto bytes = static_cast<std::size_t>(r_.integer(1, 3000));
      auto made = registry_->add_memory(name, bytes, 7);
      EXPECT_EQ(made.ok(), m_.memories.count(name) == 0);
      if (!made.ok()) return;
      fresh("memory " + name, (*made)->memory, bytes);
      m_.memories[name] = bytes;
    } else if (auto* record = registry_->find_memory(name); record != nullptr) {
      m_.forbid("memory " + name, record->memory, record->bytes, true);
      registry_->remove_memory(*record);
      EXPECT_EQ(m_.memories.erase(name), 1U);
    }
  }

  void pieces() {
    if (r_.chance(0.5) && pieces_.size() < 10) {
      const auto bytes = static_cast<std::size_t>(r_.integer(1, 2000));
      const Region region = r_.chance(0.5) ? Region::structure : Region::shared;
      auto made = registry_->allocate_memory(bytes, region);
      ASSERT_TRUE(made.ok());
      fresh("a piece", segment_->offset_of(*made), bytes);
      for (std::size_t i = 0; i < bytes; ++i) ASSERT_EQ((*made)[i], std::byte{0});
      std::memset(*made, 0x5A, bytes);
      pieces_[*made] = {bytes, region};
    } else if (!pieces_.empty()) {
      const auto [memory, piece] = r_.pick(pieces_);
      for (std::size_t i = 0; i < piece.first; ++i) ASSERT_EQ(memory[i], std::byte{0x5A});
      m_.forbid("a piece", segment_->offset_of(memory), piece.first,
                piece.second == Region::shared);
      if (piece.second == Region::structure) m_.forbidden.back().holders.clear();
      registry_->free_memory(memory);
      pieces_.erase(memory);
    }
  }

  // ---- both say the same

  void check() {
    const auto good = registry_->check_invariants();
    ASSERT_TRUE(good.ok()) << good.error().message();
    const View view(*segment_);
    ASSERT_EQ(view.pins().size(), m_.items[0].size());
    ASSERT_EQ(view.params().size(), m_.items[1].size());
    for (const auto& items : m_.items) {
      for (const auto& [original, item] : items) {
        for (const auto& name : {original, item.shown()}) {
          const auto info = item.kind == Kind::pin ? view.find_pin(name) : view.find_param(name);
          ASSERT_TRUE(info.has_value()) << name;
          EXPECT_EQ(info->name, item.shown());
          EXPECT_EQ(info->original_name, item.alias.empty() ? "" : original);
          EXPECT_EQ(info->owner, item.component);
          EXPECT_EQ(info->signal, item.signal);
          EXPECT_EQ(info->type, item.type);
          EXPECT_EQ(info->dir, item.dir);
          if (item.type != Type::port) {
            EXPECT_EQ(info->raw,
                      item.signal.empty() ? item.value : m_.signals.at(item.signal).value)
                << name;
          }
        }
      }
    }
    const auto signals = view.signals();
    ASSERT_EQ(signals.size(), m_.signals.size());
    for (const auto& info : signals) {
      const auto& signal = m_.signals.at(info.name);
      EXPECT_EQ(info.type, signal.type);
      std::set<std::string> pins;
      for (const auto& pin : info.pins) pins.insert(m_.pin(pin.name)->original);
      EXPECT_EQ(pins, signal.pins) << info.name;
      if (signal.type == Type::port) {
        const auto it = queues_.find(registry_->find_signal(info.name));
        EXPECT_EQ(info.raw, it == queues_.end() ? 0 : it->second.second);
      } else {
        EXPECT_EQ(info.raw, signal.value) << info.name;
      }
    }
    for (const auto& c : view.components()) EXPECT_EQ(c.ready, m_.components.at(c.name).ready);
    EXPECT_EQ(view.components().size(), m_.components.size());
    const auto threads = view.threads();
    EXPECT_EQ(threads.size(), m_.threads.size());
    for (const auto& t : threads) EXPECT_EQ(t.functions, m_.threads.at(t.name).functions);
    EXPECT_EQ(view.functions().size(), m_.functions.size());
    for (const auto& memory : view.memories()) EXPECT_EQ(memory.bytes, m_.memories.at(memory.name));
  }

  /// Memory for pointers and values of the C API. There is more of it than ever lives of the items that use it.
  std::uint64_t* cells(bool user) { return user ? user_cells_ : own_cells_; }
  std::uint64_t* make_cells(Region region) {
    return reinterpret_cast<std::uint64_t*>(*registry_->allocate_memory(kCells * 8, region));
  }

  static constexpr std::size_t kCells = 4096;
  Random r_;
  Model m_;
  std::unique_ptr<rtapi::Segment> segment_ = rtapi::Segment::in_memory();
  std::unique_ptr<Registry> registry_ = std::move(Registry::create(*segment_)).value();
  std::uint64_t* own_cells_ = make_cells(Region::structure);
  std::uint64_t* user_cells_ = make_cells(Region::shared);
  std::size_t next_cell_{0};
  std::uint64_t threads_made_{0};
  std::map<std::uint64_t, std::uint64_t> own_holders_;
  std::map<std::byte*, std::pair<std::size_t, Region>> pieces_;
  std::map<const Record*, std::pair<Offset, std::uint32_t>> queues_;
  std::vector<Type> types_{Type::bit, Type::bit, Type::floating, Type::s32, Type::s64, Type::port};
  std::vector<Type> param_types_{Type::bit, Type::floating, Type::s32, Type::u32, Type::u64};
  std::vector<Dir> pin_dirs_{Dir::in, Dir::in, Dir::out, Dir::io};
};

TEST(Registry, AgreesWithTheModel) {
  const unsigned first = only_seed != 0 ? only_seed : 1;
  const unsigned last = only_seed != 0 ? only_seed : machines;
  for (unsigned seed = first; seed <= last && !testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RegistryProperty(seed).run(2000);
  }
}

}  // namespace
}  // namespace kerf::hal::test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  for (int i = 1; i + 1 < argc; i += 2) {
    const auto number = static_cast<unsigned>(std::strtoul(argv[i + 1], nullptr, 10));
    if (std::string(argv[i]) == "--count") kerf::hal::test::machines = number;
    if (std::string(argv[i]) == "--seed") kerf::hal::test::only_seed = number;
  }
  return RUN_ALL_TESTS();
}
