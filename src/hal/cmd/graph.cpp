#include "hal/cmd/graph.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "hal/cmd/filter.hpp"
#include "hal/cmd/instances.hpp"
#include "hal/core/value_text.hpp"

namespace kerf::hal {

namespace {

/// Fill of a box's title by thread, fastest first; light enough for black text.
constexpr const char* kThreadColours[] = {"#ffd28a", "#a8d5f2", "#b9e3b4", "#e0c3ee", "#f5b7b1"};
constexpr const char* kNoThreadColour = "#dddddd";
constexpr std::size_t kDirectReaders = 1;  ///< more than these, and the signal becomes a node

const char* colour_of(Type type) {
  switch (type) {
    case Type::bit: return "#b03a2e";
    case Type::floating: return "#1f618d";
    case Type::s32:
    case Type::s64: return "#1e8449";
    case Type::u32:
    case Type::u64: return "#7d6608";
    default: return "#6c3483";
  }
}

std::string html(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      default: out += c;
    }
  }
  return out;
}

std::string in_quotes(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

/// "and2.0" of "and2.0.in0"; "" of a name without dots.
std::string_view without_last_word(std::string_view name) {
  const auto dot = name.rfind('.');
  return dot == std::string_view::npos ? std::string_view{} : name.substr(0, dot);
}

bool is_number(std::string_view word) {
  return !word.empty() && word.find_first_not_of("0123456789") == std::string_view::npos;
}

struct Pin {
  std::string name;
  std::string label;  ///< without the box's name
  Type type{Type::unspecified};
  Dir dir{Dir::unspecified};
  std::string value;
  std::string signal;
  bool stranger{false};
};

struct Box {
  std::string name;
  std::string owner;
  std::vector<Pin> pins;
  std::size_t hidden{0};
  bool stranger{false};
};

class Graph {
 public:
  Graph(const View& view, const GraphOptions& options, std::span<const StrangePin> strangers)
      : options_(options),
        signals_(view.signals()),
        functions_(view.functions()),
        threads_(view.threads()),
        instances_(functions_, threads_) {
    std::stable_sort(threads_.begin(), threads_.end(),
                     [](const auto& a, const auto& b) { return a.period_ns < b.period_ns; });
    for (const auto& f : functions_) functions_of_[f.owner].push_back(f.name);
    for (const auto& item : view.pins()) items_.emplace(item.name, item);
    for (const auto& s : strangers)
      if (!s.signal.empty()) strange_links_[s.signal].push_back(s);
    choose_signals();
    make_boxes(strangers);
  }

  std::string text() {
    out_ =
        "digraph hal {\n"
        "  rankdir=LR; nodesep=0.25; ranksep=\"0.5\"; bgcolor=white; splines=true;\n"
        "  node [shape=plain fontname=\"Helvetica\" fontsize=10];\n"
        "  edge [fontname=\"Helvetica\" fontsize=9 arrowsize=0.6];\n";
    put_boxes();
    for (const auto& s : signals_)
      if (chosen_.count(s.name) > 0) put_signal(s);
    for (const auto& [name, pins] : strange_links_)
      if (chosen_.count(name) > 0 && known_signals_.count(name) == 0)
        put_strange_signal(name, pins);
    put_legend();
    return out_ + "}\n";
  }

 private:
  [[nodiscard]] std::string box_name(const ItemInfo& item) const {
    const auto functions = functions_of_.find(item.owner);
    return functions == functions_of_.end() ? box_of(item.name, {})
                                            : box_of(item.name, functions->second);
  }

  [[nodiscard]] bool matches(const std::string& name) const {
    return Filter{Type::unspecified, options_.patterns}.takes(name);
  }

  /// Signals that are drawn: all, or those that a pattern names or that have a pin in a box that one names.
  void choose_signals() {
    for (const auto& s : signals_) {
      known_signals_.insert(s.name);
      const bool wanted =
          matches(s.name) || std::any_of(s.pins.begin(), s.pins.end(), [this](const auto& p) {
            const auto item = items_.find(p.name);
            return matches(p.name) || (item != items_.end() && matches(box_name(item->second)));
          });
      if (wanted) chosen_.insert(s.name);
    }
    for (const auto& [name, pins] : strange_links_) {
      const bool wanted =
          matches(name) ||
          std::any_of(pins.begin(), pins.end(), [this](const auto& p) { return matches(p.name); });
      if (wanted) chosen_.insert(name);
    }
  }

  void make_boxes(std::span<const StrangePin> strangers) {
    for (const auto& [name, item] : items_) {
      const std::string box = box_name(item);
      // A function's own figures are in `show`, not in the picture.
      if (is_function(item.owner, std::string(without_last_word(name))) && name.ends_with(".time"))
        continue;
      const bool linked = !item.signal.empty() && chosen_.count(item.signal) > 0;
      const bool wanted = linked || (item.signal.empty() && matches(box));
      if (!wanted || item.owner.rfind("__", 0) == 0) continue;
      Box& b = boxes_[box];
      b.name = box;
      b.owner = item.owner;
      if (!linked && !options_.all_pins) {
        ++b.hidden;
        continue;
      }
      b.pins.push_back({name, label(name, box), item.type, item.dir,
                        plain_value_text(item.type, item.raw), item.signal, false});
    }
    // Of a component that is all one object, the parts with nothing to draw say nothing.
    std::set<std::string> drawn;
    for (const auto& [name, box] : boxes_)
      if (!box.pins.empty()) drawn.insert(box.owner);
    std::erase_if(boxes_, [&](const auto& entry) {
      const Box& box = entry.second;
      return box.pins.empty() &&
             (places(box).empty() || (sole_instance(box.owner) && drawn.count(box.owner) > 0));
    });
    for (const auto& s : strangers) {
      if (s.signal.empty() || chosen_.count(s.signal) == 0) continue;
      const std::string box = box_of(s.name, {});
      Box& b = boxes_[box];
      b.name = box;
      b.stranger = b.owner.empty();
      const bool there = std::any_of(b.pins.begin(), b.pins.end(),
                                     [&s](const Pin& p) { return p.name == s.name; });
      if (!there)
        b.pins.push_back(
            {s.name, label(s.name, box), Type::unspecified, s.dir, "", s.signal, true});
    }
  }

  [[nodiscard]] static std::string label(const std::string& name, const std::string& box) {
    return name.size() > box.size() + 1 ? name.substr(box.size() + 1) : name;
  }
  [[nodiscard]] bool is_function(const std::string& owner, const std::string& name) const {
    const auto it = functions_of_.find(owner);
    return it != functions_of_.end() &&
           std::find(it->second.begin(), it->second.end(), name) != it->second.end();
  }

  /// Where the functions of a box run: "servo-thread 3, 4", and the first thread's number.
  struct Place {
    std::size_t thread;
    std::string text;
  };
  [[nodiscard]] std::vector<Place> places(const Box& box) const {
    std::vector<Place> out;
    const auto functions = functions_of_.find(box.owner);
    if (functions == functions_of_.end()) return out;
    std::set<std::string> mine;
    for (const auto& f : functions->second)
      if (f == box.name || f.rfind(box.name + ".", 0) == 0) mine.insert(f);
    if (mine.empty() && sole_instance(box.owner))
      mine.insert(functions->second.begin(), functions->second.end());
    for (std::size_t t = 0; t < threads_.size(); ++t) {
      std::string numbers;
      for (std::size_t i = 0; i < threads_[t].functions.size(); ++i)
        if (mine.count(threads_[t].functions[i]) > 0)
          numbers += (numbers.empty() ? " " : ", ") + std::to_string(i + 1);
      if (!numbers.empty()) out.push_back({t, threads_[t].name + numbers});
    }
    return out;
  }
  [[nodiscard]] bool sole_instance(const std::string& owner) const {
    std::size_t n = 0;
    for (std::size_t i = 0; i < instances_.size(); ++i) n += instances_.at(i).owner == owner;
    return n == 1;
  }

  // ---- text -------------------------------------------------------------------------------------

  [[nodiscard]] std::string cell(const Pin& pin, bool left) const {
    std::string text = html(pin.label);
    if (pin.dir == Dir::io) text = left ? "&#8596; " + text : text + " &#8596;";
    if (pin.stranger) text = "<i>" + text + "</i>";
    if (options_.values && !pin.value.empty())
      text += " <font color=\"#777777\">" + html(pin.value) + "</font>";
    return "<td port=\"" + html(pin.name) + "\" align=\"" + (left ? "left" : "right") + "\">" +
           text + "</td>";
  }

  /// Pins that read stand left, those that write right; one of a stranger may do either.
  [[nodiscard]] static bool stands_left(const Pin& pin) { return pin.dir != Dir::out; }

  void put_box(const Box& box, const char* indent) {
    std::vector<const Pin*> left, right;
    for (const auto& pin : box.pins) (stands_left(pin) ? left : right).push_back(&pin);
    const auto runs = places(box);
    std::string where;
    for (const auto& p : runs) where += (where.empty() ? "" : "; ") + p.text;
    const char* fill = runs.empty()
                           ? kNoThreadColour
                           : kThreadColours[runs.front().thread % std::size(kThreadColours)];
    out_ += std::string(indent) + in_quotes(box.name) +
            " [label=<<table border=\"1\" cellborder=\"0\" cellspacing=\"0\" cellpadding=\"3\"" +
            (box.stranger ? " style=\"dashed\"" : "") + ">" + "<tr><td colspan=\"2\" bgcolor=\"" +
            fill + "\"><b>" + html(box.name) + "</b>";
    if (!where.empty()) out_ += "<br/><font point-size=\"8\">" + html(where) + "</font>";
    if (box.stranger) out_ += "<br/><font point-size=\"8\">not loaded here</font>";
    out_ += "</td></tr>";
    for (std::size_t i = 0; i < std::max(left.size(), right.size()); ++i) {
      out_ += "<tr>" + (i < left.size() ? cell(*left[i], true) : "<td></td>") +
              (i < right.size() ? cell(*right[i], false) : "<td></td>") + "</tr>";
    }
    if (box.hidden > 0) {
      out_ += "<tr><td colspan=\"2\"><font color=\"#999999\" point-size=\"8\">" +
              std::to_string(box.hidden) + " not linked</font></td></tr>";
    }
    out_ += "</table>>];\n";
  }

  void put_boxes() {
    // The boxes of one component that has several and no instances (motmod) stand in a frame.
    std::map<std::string, std::vector<const Box*>> by_owner;
    for (const auto& [name, box] : boxes_) by_owner[box.owner].push_back(&box);
    for (const auto& [owner, boxes] : by_owner) {
      const bool framed = !owner.empty() && boxes.size() > 1 && sole_instance(owner);
      if (framed)
        out_ += "  subgraph " + in_quotes("cluster_" + owner) + " { label=" + in_quotes(owner) +
                "; color=\"#bbbbbb\"; fontname=\"Helvetica\"; fontsize=11;\n";
      for (const Box* box : boxes) put_box(*box, framed ? "    " : "  ");
      if (framed) out_ += "  }\n";
    }
  }

  [[nodiscard]] std::string port(const std::string& pin, bool writes) const {
    const auto item = items_.find(pin);
    const std::string box = item == items_.end() ? box_of(pin, {}) : box_name(item->second);
    // A stranger's cell and an I/O pin's are reached from either side.
    return in_quotes(box) + ":" + in_quotes(pin) + (writes ? ":e" : ":w");
  }

  /// Node for a signal, with a line to each pin.
  void put_node(const std::string& id, const std::string& text, const char* colour, bool lonely,
                const char* style = "rounded") {
    out_ += "  " + in_quotes(id) + " [shape=box style=\"" + style +
            std::string(lonely ? ",dashed" : "") + "\" margin=\"0.06,0.02\" height=0.2 fontsize=9" +
            " color=\"" + colour + "\" fontcolor=\"" + colour + "\" label=" + in_quotes(text) +
            "];\n";
  }

  void put_edge(const std::string& from, const std::string& to, const std::string& attributes) {
    out_ += "  " + from + " -> " + to + " [" + attributes + "];\n";
  }

  [[nodiscard]] bool is_late(const std::string& writer, const std::string& reader) const {
    const auto w = items_.find(writer), r = items_.find(reader);
    return w != items_.end() && r != items_.end() && instances_.late(w->second, r->second);
  }

  void put_signal(const SignalInfo& s) {
    std::vector<std::string> writers, readers, both;
    for (const auto& pin : s.pins)
      (pin.dir == Dir::out ? writers : pin.dir == Dir::in ? readers : both).push_back(pin.name);
    const auto strange = strange_links_.find(s.name);
    const std::string colour =
        std::string("color=\"") + colour_of(s.type) + "\" fontcolor=\"" + colour_of(s.type) + "\"";
    const std::string value = options_.values ? plain_value_text(s.type, s.raw) : std::string();
    const std::string text = value.empty() ? s.name : s.name + " = " + value;
    const bool one_to_one = strange == strange_links_.end() && both.empty() &&
                            writers.size() == 1 && readers.size() == kDirectReaders;
    if (one_to_one && !is_late(writers[0], readers[0])) {
      put_edge(port(writers[0], true), port(readers[0], false),
               "label=" + in_quotes(text) + " " + colour);
      return;
    }
    const std::string node = in_quotes("=" + s.name);
    const bool lonely =
        strange == strange_links_.end() && both.empty() && (writers.empty() || readers.empty());
    put_node("=" + s.name, text, colour_of(s.type), lonely);
    for (const auto& pin : writers) put_edge(port(pin, true), node, colour + " arrowhead=none");
    for (const auto& pin : both) put_edge(node, port(pin, false), colour + " dir=both");
    for (const auto& pin : readers) {
      if (writers.size() == 1 && is_late(writers[0], pin))
        put_late_edge(s.name, pin, colour_of(s.type));
      else
        put_edge(node, port(pin, false), colour);
    }
    if (strange != strange_links_.end()) put_strange_edges(s.name, strange->second);
  }

  /// A line back to where it came from would run around everything: the signal's name stands at both ends instead.
  void put_late_edge(const std::string& signal, const std::string& reader, const char* colour) {
    const std::string tag = "=" + signal + "=" + reader;
    put_node(tag, signal, colour, false, "dotted");
    put_edge(in_quotes(tag), port(reader, false),
             std::string("color=\"") + colour + "\" style=dashed");
  }

  void put_strange_edges(const std::string& signal, const std::vector<StrangePin>& pins) {
    const std::string node = in_quotes("=" + signal);
    std::set<std::string> told, writers;
    for (const auto& pin : pins)
      if (pin.dir == Dir::out) writers.insert(box_of(pin.name, {}));
    for (const auto& pin : pins) {
      if (!told.insert(pin.name).second) continue;
      if (pin.dir == Dir::out)
        put_edge(port(pin.name, true), node, "color=\"#777777\" arrowhead=none");
      else if (writers.count(box_of(pin.name, {})) > 0)
        put_late_edge(signal, pin.name, "#777777");
      else
        put_edge(node, port(pin.name, false),
                 std::string("color=\"#777777\"") +
                     (pin.dir == Dir::unspecified ? " arrowhead=none" : ""));
    }
  }

  void put_strange_signal(const std::string& name, const std::vector<StrangePin>& pins) {
    put_node("=" + name, name, "#777777", false);
    put_strange_edges(name, pins);
  }

  void put_legend() {
    out_ +=
        "  legend [label=<<table border=\"0\" cellborder=\"0\" cellspacing=\"1\" "
        "cellpadding=\"2\">";
    for (std::size_t t = 0; t < threads_.size(); ++t) {
      out_ += "<tr><td bgcolor=\"" + std::string(kThreadColours[t % std::size(kThreadColours)]) +
              "\">" + html(threads_[t].name) + "</td><td align=\"left\">" +
              period_text(threads_[t].period_ns) + "</td></tr>";
    }
    for (const Type type : {Type::bit, Type::floating, Type::s32, Type::u32}) {
      std::string name(type_name(type));
      if (type == Type::s32) name = "s32, s64";
      if (type == Type::u32) name = "u32, u64";
      out_ += "<tr><td><font color=\"" + std::string(colour_of(type)) + "\">&#9473;&#9473;</font>" +
              "</td><td align=\"left\">" + name + "</td></tr>";
    }
    out_ +=
        "<tr><td>- - -</td><td align=\"left\">one cycle later</td></tr>"
        "<tr><td>name 3</td><td align=\"left\">third in its thread</td></tr></table>>];\n";
  }
  static std::string period_text(std::int64_t ns) {
    if (ns % 1'000'000 == 0) return std::to_string(ns / 1'000'000) + " ms";
    if (ns % 1'000 == 0) return std::to_string(ns / 1'000) + " us";
    return std::to_string(ns) + " ns";
  }

  const GraphOptions& options_;
  std::vector<SignalInfo> signals_;
  std::vector<FunctionInfo> functions_;
  std::vector<ThreadInfo> threads_;
  Instances instances_;
  std::map<std::string, ItemInfo> items_;
  std::map<std::string, std::vector<std::string>> functions_of_;
  std::map<std::string, std::vector<StrangePin>> strange_links_;
  std::set<std::string> known_signals_;
  std::set<std::string> chosen_;
  std::map<std::string, Box> boxes_;
  std::string out_;
};

}  // namespace

std::string box_of(std::string_view pin, std::span<const std::string> functions) {
  std::string_view best = pin.substr(0, pin.find('.'));
  const std::string_view stem = without_last_word(pin);
  for (std::size_t begin = 0; begin < stem.size();) {
    const auto end = std::min(stem.find('.', begin), stem.size());
    if (is_number(stem.substr(begin, end - begin))) best = stem.substr(0, end);
    begin = end + 1;
  }
  for (const std::string_view f : functions) {
    for (const std::string_view name : {f, without_last_word(f)}) {
      const bool fits = name.size() > best.size() && pin.size() > name.size() &&
                        pin.starts_with(name) && pin[name.size()] == '.';
      if (fits) best = name;
    }
  }
  return std::string(best);
}

std::string graph_dot(const View& view, const GraphOptions& options,
                      std::span<const StrangePin> strangers) {
  return Graph(view, options, strangers).text();
}

}  // namespace kerf::hal
