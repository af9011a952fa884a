#include "hal/cmd/describe.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <deque>
#include <new>
#include <sstream>

#include "hal/cmd/check.hpp"
#include "hal/core/records.hpp"
#include "hal/core/value_access.hpp"
#include "hal/core/value_text.hpp"
#include "hal/loader/c_parameters.hpp"
#include "rtapi/clock/clock.hpp"

namespace kerf::hal {

using rtapi::Errc;
using rtapi::fail;
using rtapi::Result;

namespace {

class StillClock final : public rtapi::Clock {
 public:
  [[nodiscard]] rtapi::Nanos now() const noexcept override { return 0; }
  [[nodiscard]] bool is_virtual() const noexcept override { return true; }
};

}  // namespace

/// Keeps what one component declares, and the component as long as others may use it.
class Describer::Recorder final : public Builder {
 public:
  Recorder(Describer& owner, const Module& module, const std::string& name)
      : owner_(owner), module_(module) {
    const Info& info = module.info;
    declaration_.name = name;
    declaration_.summary = std::string(info.summary);
    declaration_.notes = std::string(info.notes);
    declaration_.license = std::string(info.license);
    declaration_.example = std::string(info.example);
    declaration_.singleton = info.singleton;
    prefix_ = Name(info.name);
    if (!info.singleton) prefix_.append(".N");
    declares_only_ = true;
    std::istringstream words{declaration_.example};
    for (std::string word; words >> word;) {
      const auto equals = word.find('=');
      if (equals == std::string::npos) continue;
      given_[word.substr(0, equals)] = word.substr(equals + 1);
    }
    if (const auto it = given_.find("personality"); it != given_.end()) {
      const auto value = parse_value(Type::s64, it->second);
      if (value.ok()) personality_ = from_raw<std::int64_t>(*value);
    }
  }
  ~Recorder() {
    if (object_ != nullptr) module_.destroy(object_);
    owner_.modules_.close(&module_);
  }
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  void create() {
    object_ = allocate(module_.size, module_.align);
    module_.create(object_, *this);
    declaration_.incomplete = error_;
  }
  [[nodiscard]] const Declaration& declaration() const { return declaration_; }
  /// A service that it asked for and that nobody provides.
  [[nodiscard]] const std::string& missing() const { return missing_; }
  [[nodiscard]] const std::map<std::string, void*, std::less<>>& provided() const {
    return provided_;
  }

  void add_pin(std::string_view name, Type type, Dir dir, std::uint64_t initial,
               std::string_view doc, PinCell* cell) noexcept override {
    std::uint64_t& value = add_item(name, type, dir, initial, doc);
    if (cell != nullptr) cell->point(slot_of(value));
  }
  FixedSlot add_param(std::string_view name, Type type, Dir dir, std::uint64_t initial,
                      std::string_view doc) noexcept override {
    return {&slot_of(add_item(name, type, dir, initial, doc))};
  }
  void add_function(std::string_view name, FunctionThunk /*thunk*/, void* /*object*/,
                    std::string_view doc) noexcept override {
    declaration_.functions.push_back({std::string(name), std::string(doc)});
  }
  std::string_view arg(std::string_view name, std::string_view default_text,
                       std::string_view doc) noexcept override {
    auto& all = declaration_.arguments;
    if (std::none_of(all.begin(), all.end(), [&](const auto& a) { return a.name == name; }))
      all.push_back({std::string(name), std::string(default_text), std::string(doc)});
    const auto it = given_.find(name);
    return texts_.emplace_back(it == given_.end() ? std::string(default_text) : it->second);
  }
  void* allocate(std::size_t bytes, std::size_t align) noexcept override {
    auto* data = static_cast<std::byte*>(::operator new(bytes, std::align_val_t(align)));
    std::memset(data, 0, bytes);
    memory_.emplace_back(data, Free{align});
    return data;
  }
  std::byte* shared_block(std::string_view /*name*/, std::size_t bytes,
                          std::uint64_t /*abi*/) noexcept override {
    return static_cast<std::byte*>(allocate(bytes, 64));
  }
  void provide(std::string_view service, void* object) noexcept override {
    provided_.emplace(service, object);
  }
  void* find_service(std::string_view service) noexcept override {
    const auto it = owner_.services_.find(service);
    if (it != owner_.services_.end()) return it->second;
    missing_ = std::string(service);
    return nullptr;
  }
  void add_participant(rtapi::Participant& /*participant*/) noexcept override {}
  void add_thread(std::string_view name, std::int64_t period_ns) noexcept override {
    declaration_.threads.push_back({std::string(name), period_ns});
  }
  [[nodiscard]] const rtapi::Clock& clock() const noexcept override { return clock_; }
  void fail(std::string_view what) noexcept override {
    if (error_.empty()) error_ = what.empty() ? "error" : std::string(what);
  }
  [[nodiscard]] bool failed() const noexcept override { return !error_.empty(); }

 private:
  struct Free {
    std::size_t align;
    void operator()(std::byte* p) const noexcept { ::operator delete(p, std::align_val_t(align)); }
  };

  std::uint64_t& add_item(std::string_view name, Type type, Dir dir, std::uint64_t initial,
                          std::string_view doc) noexcept {
    declaration_.items.push_back({std::string(name), type, dir, initial, std::string(doc)});
    return values_.emplace_back(initial);
  }

  Describer& owner_;
  const Module& module_;
  Declaration declaration_;
  std::map<std::string, std::string, std::less<>> given_;
  std::map<std::string, void*, std::less<>> provided_;
  std::deque<std::string> texts_;
  std::deque<std::uint64_t> values_;
  std::vector<std::unique_ptr<std::byte, Free>> memory_;
  void* object_{nullptr};
  std::string missing_;
  std::string error_;
  StillClock clock_;
};

Describer::Describer(ModuleSource& modules) : modules_(modules) {}

Describer::~Describer() {
  while (!recorders_.empty()) recorders_.pop_back();
}

Result<std::unique_ptr<Describer::Recorder>> Describer::declare(const std::string& name) {
  for (bool again = true;; again = false) {
    KERF_TRY(const Module* module, modules_.open(name));
    if (module->c_library != nullptr) {
      modules_.close(module);
      return fail(Errc::bad_argument, "'" + name + "' is written in C");
    }
    auto recorder = std::make_unique<Recorder>(*this, *module, name);
    recorder->create();
    const std::string missing = recorder->missing();
    // A search within the search for the same service would find nothing else.
    if (!again || missing.empty() || !searching_.insert(missing).second) return recorder;
    recorder.reset();
    find_provider(missing);
    searching_.erase(missing);
  }
}

void Describer::find_provider(const std::string& service) {
  for (const auto& name : modules_.names()) {
    auto made = declare(name);
    if (!made.ok() || (*made)->provided().empty()) continue;
    for (const auto& [provided, object] : (*made)->provided()) services_.emplace(provided, object);
    recorders_.push_back(std::move(*made));
    if (services_.count(service) > 0) return;
  }
}

Result<Declaration> Describer::describe_c(const std::string& name,
                                          const std::vector<std::string>& loadrt_words) {
  Declaration d;
  d.name = name;
  d.summary = "component written in C";
  d.singleton = true;  // count= and its like are parameters of its own, if it has them
  KERF_TRY(const Module* module, modules_.open(name));
  for (const auto& p : c_parameters(module->c_library)) {
    const std::string what =
        p.elements > 0 ? p.type + "s, up to " + std::to_string(p.elements) : p.type;
    d.arguments.push_back(
        {p.name, p.default_text,
         p.description.empty() ? "(" + what + ")" : p.description + " (" + what + ")"});
  }
  modules_.close(module);
  // Compilers put them into the module in any order.
  std::sort(d.arguments.begin(), d.arguments.end(),
            [](const auto& a, const auto& b) { return a.name < b.name; });
  std::string line = "loadrt " + name;
  for (const auto& word : loadrt_words) {
    line += " " + word;
    d.example += (d.example.empty() ? "" : " ") + word;
  }
  ScriptCheck load(modules_, nullptr);
  load.run_text(line + "\n", name);
  for (const auto& finding : load.finish()) {
    if (finding.kind != "device" && finding.kind != "command") continue;
    d.incomplete = finding.text + "; name the parameters that it needs, as for loadrt";
    break;
  }
  const View& view = load.view();
  std::set<std::string> own;  // of functions and threads: every one has them
  for (const auto& function : view.functions()) {
    d.functions.push_back({function.name, ""});
    for (const char* item : {".time", ".tmax", ".tmax-increased"}) own.insert(function.name + item);
  }
  for (const auto& thread : view.threads()) {
    d.threads.push_back({thread.name, thread.period_ns});
    for (const char* item : {".time", ".tmax", ".threadbeat"}) own.insert(thread.name + item);
  }
  for (const auto& items : {view.pins(), view.params()}) {
    for (const auto& item : items) {
      if (own.count(item.name) == 0)
        d.items.push_back({item.name, item.type, item.dir, item.raw, ""});
    }
  }
  return d;
}

Result<Declaration> Describer::describe(const std::string& name,
                                        const std::vector<std::string>& loadrt_words) {
  KERF_TRY(const Module* module, modules_.open(name));
  const bool in_c = module->c_library != nullptr;
  modules_.close(module);
  if (in_c) return describe_c(name, loadrt_words);
  KERF_TRY(const auto recorder, declare(name));
  return recorder->declaration();
}

// ---- groups -------------------------------------------------------------------------------------

namespace {

/// The name with its `which`-th run of digits taken out, and that number; false: there is none.
bool take_number(const std::string& name, std::size_t which, std::string& rest, std::size_t& number,
                 std::size_t& width) {
  std::size_t i = 0;
  while (i < name.size()) {
    if (std::isdigit(static_cast<unsigned char>(name[i])) == 0) {
      ++i;
      continue;
    }
    std::size_t end = i;
    while (end < name.size() && std::isdigit(static_cast<unsigned char>(name[end])) != 0) ++end;
    if (which-- == 0 && end - i < 9) {
      number = std::stoul(name.substr(i, end - i));
      width = end - i;
      rest = name.substr(0, i) + '\0' + name.substr(end);
      return true;
    }
    i = end;
  }
  return false;
}

bool alike(const Declaration::Item& a, const Declaration::Item& b) {
  return a.type == b.type && a.dir == b.dir && a.initial == b.initial && a.doc == b.doc;
}

}  // namespace

std::vector<ItemGroup> grouped(const Declaration& d, bool pins) {
  std::vector<const Declaration::Item*> items;
  for (const auto& item : d.items)
    if (item.is_pin() == pins) items.push_back(&item);
  std::vector<bool> told(items.size(), false);
  std::vector<ItemGroup> out;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (told[i]) continue;
    ItemGroup best{items[i]->name, "", items[i]};
    std::vector<std::size_t> best_members;
    std::string rest;
    std::size_t first = 0, width = 0;
    for (std::size_t which = 0; take_number(items[i]->name, which, rest, first, width); ++which) {
      std::vector<std::size_t> members{i};
      std::size_t last = first;
      for (std::size_t j = i + 1; j < items.size(); ++j) {
        std::string other;
        std::size_t number = 0, other_width = 0;
        if (told[j] || !alike(*items[i], *items[j]) ||
            !take_number(items[j]->name, which, other, number, other_width) || other != rest ||
            number != last + 1)
          continue;
        members.push_back(j);
        last = number;
      }
      if (members.size() < 2 || members.size() <= best_members.size()) continue;
      best.name = rest;
      const std::string m(width > 1 ? width : 1, 'M');
      best.name.replace(best.name.find('\0'), 1, m);
      const auto padded = [width = width](std::size_t n) {
        const std::string digits = std::to_string(n);
        return std::string(width - std::min(width, digits.size()), '0') + digits;
      };
      best.range = m + " from " + padded(first) + " to " + padded(last);
      best_members = members;
    }
    for (const std::size_t j : best_members) told[j] = true;
    out.push_back(best);
  }
  return out;
}

}  // namespace kerf::hal
