// ScriptCheck: what HAL as a whole shows, once the scripts are done.
#include <algorithm>
#include <deque>
#include <optional>

#include "hal/cmd/check.hpp"
#include "hal/cmd/instances.hpp"
#include "hal/core/value_text.hpp"

namespace kerf::hal {

namespace {

using Level = Finding::Level;
constexpr std::size_t kMostNames = 6;

std::string in_quotes(std::string_view s) { return "'" + std::string(s) + "'"; }

/// "a, b, c and 4 more".
std::string some(const std::vector<std::string>& names) {
  std::string out;
  for (std::size_t i = 0; i < names.size() && i < kMostNames; ++i)
    out += (i > 0 ? ", " : "") + names[i];
  if (names.size() > kMostNames)
    out += " and " + std::to_string(names.size() - kMostNames) + " more";
  return out;
}

std::string counted(std::size_t n, const char* one) {
  return std::to_string(n) + " " + one + (n == 1 ? "" : "s");
}

/// One pin that writes a signal and one that reads it, in functions of one thread.
struct Flow {
  std::size_t from, to;  ///< instances
  std::string writer, signal, reader;
  std::string thread;
  bool late;  ///< the reader runs before the writer

  [[nodiscard]] std::string text() const { return writer + " => " + signal + " => " + reader; }
};

class Analysis {
 public:
  Analysis(const View& view, const ScriptTrace& trace)
      : trace_(trace),
        components_(view.components()),
        pins_(view.pins()),
        signals_(view.signals()),
        functions_(view.functions()),
        threads_(view.threads()),
        instances_(functions_, threads_) {}

  std::vector<Finding> all() {
    silent_signals();
    idle_functions();
    empty_threads();
    unset_inputs();
    find_flows();
    late_flows();
    unchecked_pins();
    return std::move(out_);
  }

 private:
  void add(Level level, const char* kind, const ScriptPlace& at, std::string text) {
    out_.push_back({level, kind, at, std::move(text)});
  }
  template <class Map>
  static ScriptPlace place(const Map& map, const std::string& name) {
    const auto it = map.find(name);
    return it == map.end() ? ScriptPlace{"(HAL)", 0} : it->second;
  }
  [[nodiscard]] bool has_unchecked_pin(const std::string& signal) const {
    return std::any_of(trace_.unchecked.begin(), trace_.unchecked.end(),
                       [&signal](const UncheckedPin& p) { return p.signal == signal; });
  }

  void silent_signals() {
    for (const auto& s : signals_) {
      if (has_unchecked_pin(s.name) || s.bidirs > 0) continue;
      const auto at = place(trace_.signals, s.name);
      std::vector<std::string> names;
      for (const auto& pin : s.pins) names.push_back(pin.name);
      if (s.pins.empty()) {
        add(Level::note, "no-pins", at, "signal " + in_quotes(s.name) + " has no pins");
      } else if (s.writers == 0 && trace_.set_signals.count(s.name) == 0) {
        add(Level::warning, "no-writer", at,
            "nothing writes signal " + in_quotes(s.name) + ", which " + some(names) +
                (names.size() == 1 ? " reads" : " read") + ": it stays " +
                value_text(s.type, s.raw));
      } else if (s.readers == 0) {
        add(Level::note, "no-reader", at,
            "nothing reads signal " + in_quotes(s.name) + ", which " + some(names) + " writes");
      }
    }
  }

  void idle_functions() {
    std::map<std::string, std::vector<const FunctionInfo*>> by_owner;
    for (const auto& f : functions_) by_owner[f.owner].push_back(&f);
    for (const auto& [owner, functions] : by_owner) {
      const auto at = place(trace_.loaded, owner);
      const auto runs = [this](const FunctionInfo& f) {
        return f.users > 0 || trace_.added.count(f.name) > 0;
      };
      if (std::none_of(functions.begin(), functions.end(),
                       [&runs](const FunctionInfo* f) { return runs(*f); })) {
        std::vector<std::string> names;
        for (const auto* f : functions) names.push_back(f->name);
        add(Level::warning, "not-run", at,
            "component " + in_quotes(owner) + " never runs: none of its functions (" + some(names) +
                ") is in a thread");
        continue;
      }
      for (const auto* f : functions) {
        if (runs(*f)) continue;
        // Another function of the same instance runs: this one may be an alternative.
        const bool partly = std::any_of(
            functions.begin(), functions.end(),
            [&](const FunctionInfo* o) { return o->argument == f->argument && runs(*o); });
        add(partly ? Level::note : Level::warning, "not-run", at,
            "function " + in_quotes(f->name) + " is in no thread, so it never runs");
      }
    }
  }

  void empty_threads() {
    for (const auto& t : threads_) {
      if (!t.functions.empty()) continue;
      const auto owner = t.owner.rfind("__", 0) == 0 ? loader_of_threads() : t.owner;
      if (!functions_.empty())
        add(Level::note, "empty-thread", place(trace_.loaded, owner),
            "thread " + in_quotes(t.name) + " runs no function");
    }
  }
  /// Threads show as components of their own; the one that made them is the one that makes threads.
  [[nodiscard]] std::string loader_of_threads() const {
    for (const char* name : {"motmod", "threads"})
      if (trace_.loaded.count(name) > 0) return name;
    return {};
  }

  void unset_inputs() {
    std::map<std::string, std::vector<std::string>> by_owner;
    for (const auto& pin : pins_) {
      if (pin.dir != Dir::in || !pin.signal.empty() || trace_.set_items.count(pin.name) > 0)
        continue;
      by_owner[pin.owner].push_back(pin.name);
    }
    for (const auto& [owner, names] : by_owner) {
      add(Level::note, "unset-inputs", place(trace_.loaded, owner),
          counted(names.size(), "input") + " of component " + in_quotes(owner) +
              (names.size() == 1 ? " is" : " are") + " neither linked nor set: " + some(names));
    }
  }

  void find_flows() {
    std::map<std::string, const ItemInfo*> pins;
    for (const auto& pin : pins_) pins[pin.name] = &pin;
    for (const auto& s : signals_) {
      for (const auto& from : s.pins) {
        if (from.dir != Dir::out) continue;
        for (const auto& to : s.pins)
          if (to.dir == Dir::in) add_flow(*pins.at(from.name), s.name, *pins.at(to.name));
      }
    }
  }

  void add_flow(const ItemInfo& writer, const std::string& signal, const ItemInfo& reader) {
    const auto from = instances_.of_pin(writer), to = instances_.of_pin(reader);
    if (!from || !to) return;
    for (const auto& [thread, w] : instances_.at(*from).runs) {
      const auto r = instances_.at(*to).runs.find(thread);
      if (r == instances_.at(*to).runs.end()) continue;
      // Which of an instance's functions uses the pin is not known: late is only what is late with any of them.
      const bool late = *from == *to ? false : w.front() > r->second.back();
      flows_.push_back({*from, *to, writer.name, signal, reader.name, thread, late});
    }
  }

  /// The shortest way from one instance to another along the flows of a thread.
  [[nodiscard]] std::optional<std::vector<const Flow*>> way(std::size_t from, std::size_t to,
                                                            const std::string& thread) const {
    std::map<std::size_t, const Flow*> came{{from, nullptr}};
    std::deque<std::size_t> queue{from};
    while (!queue.empty() && came.count(to) == 0) {
      const std::size_t at = queue.front();
      queue.pop_front();
      for (const auto& f : flows_) {
        if (f.from != at || f.thread != thread || came.count(f.to) > 0) continue;
        came[f.to] = &f;
        queue.push_back(f.to);
      }
    }
    if (came.count(to) == 0) return std::nullopt;
    std::vector<const Flow*> out;
    for (const Flow* f = came[to]; f != nullptr; f = came[f->from]) out.push_back(f);
    std::reverse(out.begin(), out.end());
    return out;
  }

  [[nodiscard]] ScriptPlace place_of(const Instance& instance, const std::string& thread) const {
    const auto runs = instance.runs.find(thread);
    if (runs == instance.runs.end()) return {"(HAL)", 0};
    for (const auto& f : instance.functions)
      if (trace_.added.count(f) > 0) return trace_.added.at(f);
    return {"(HAL)", 0};
  }

  void late_flows() {
    std::set<std::vector<std::size_t>> told;  // thread and instances
    for (std::size_t i = 0; i < flows_.size(); ++i) {
      const Flow& f = flows_[i];
      const bool own = f.from == f.to;
      if (!f.late && !own) continue;
      const auto thread = static_cast<std::size_t>(
          std::find_if(threads_.begin(), threads_.end(),
                       [&f](const ThreadInfo& t) { return t.name == f.thread; }) -
          threads_.begin());
      if (!told.insert({thread, f.from, f.to}).second) continue;
      const Instance& writer = instances_.at(f.from);
      const Instance& reader = instances_.at(f.to);
      std::vector<std::string> same;
      for (const auto& other : flows_)
        if (&other != &f && other.from == f.from && other.to == f.to && other.thread == f.thread)
          same.push_back(in_quotes(other.signal));
      std::sort(same.begin(), same.end());
      same.erase(std::unique(same.begin(), same.end()), same.end());
      std::erase(same, in_quotes(f.signal));
      const std::string more = same.empty() ? "" : "; so do " + some(same);
      const auto at = place_of(writer, f.thread);
      const auto back = own ? std::optional<std::vector<const Flow*>>(std::vector<const Flow*>{})
                            : way(f.to, f.from, f.thread);
      if (back) {
        std::string chain = f.text();
        for (const Flow* step : *back) chain += ", " + step->text();
        add(Level::note, "loop", at,
            ("loop in thread " + in_quotes(f.thread))
                .append(": ")
                .append(chain)
                .append("; signal ")
                .append(in_quotes(f.signal))
                .append(" always carries the value of the cycle before")
                .append(more));
      } else {
        add(Level::note, "order", at,
            "signal " + in_quotes(f.signal) + " arrives one cycle late: in thread " +
                in_quotes(f.thread) + " " + position(writer, f.thread, false) + " runs after " +
                position(reader, f.thread, true) + " (" + f.text() + ")" + more);
      }
    }
  }
  [[nodiscard]] std::string position(const Instance& instance, const std::string& thread,
                                     bool last) const {
    const auto& runs = instance.runs.at(thread);
    const std::size_t at = last ? runs.back() : runs.front();
    for (const auto& t : threads_)
      if (t.name == thread) return t.functions.at(at - 1) + " (" + std::to_string(at) + ")";
    return {};
  }

  void unchecked_pins() {
    std::map<std::string, std::pair<ScriptPlace, std::vector<std::string>>> by_prefix;
    for (const auto& pin : trace_.unchecked) {
      auto& [at, names] = by_prefix[pin.name.substr(0, pin.name.find('.'))];
      if (names.empty()) at = pin.at;
      if (std::find(names.begin(), names.end(), pin.name) == names.end()) names.push_back(pin.name);
    }
    for (const auto& [prefix, row] : by_prefix) {
      add(Level::note, "unchecked", row.first,
          "not checked, for " + in_quotes(prefix) + " is not loaded here: " + some(row.second));
    }
  }

  const ScriptTrace& trace_;
  std::vector<ComponentInfo> components_;
  std::vector<ItemInfo> pins_;
  std::vector<SignalInfo> signals_;
  std::vector<FunctionInfo> functions_;
  std::vector<ThreadInfo> threads_;
  Instances instances_;
  std::vector<Flow> flows_;
  std::vector<Finding> out_;
};

}  // namespace

std::vector<Finding> analyse(const View& view, const ScriptTrace& trace) {
  return Analysis(view, trace).all();
}

}  // namespace kerf::hal
