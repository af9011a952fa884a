#include "hal/tcl/loadrt_merge.hpp"

#include <algorithm>
#include <charconv>
#include <string_view>

namespace kerf::hal::tcl {

using rtapi::Errc;
using rtapi::fail;
using rtapi::Result;
using rtapi::Status;

namespace {

constexpr std::string_view kPersonality = "personality";

/// How the instances of a module are told: only one of these a module.
bool is_form(std::string_view key) { return key == "count" || key == "num_chan" || key == "names"; }

std::vector<std::string_view> elements(std::string_view list) {
  std::vector<std::string_view> out;
  while (true) {
    const auto comma = list.find(',');
    out.push_back(list.substr(0, comma));
    if (comma == std::string_view::npos) return out;
    list.remove_prefix(comma + 1);
  }
}

Result<long> number(const std::string& module, const LoadrtMerge::Parameter& p) {
  long value = 0;
  const auto* end = p.value.data() + p.value.size();
  const auto [stop, error] = std::from_chars(p.value.data(), end, value);
  if (error != std::errc() || stop != end || value < 0) {
    return fail(Errc::bad_argument,
                "loadrt " + module + ": " + p.key + "='" + p.value + "' is not a number");
  }
  return value;
}

void append(std::string& list, const std::string& more) {
  if (!list.empty() && !more.empty()) list += ',';
  list += more;
}

std::string repeated(std::string_view element, std::size_t count) {
  std::string out;
  for (std::size_t i = 0; i < count; ++i) append(out, std::string(element));
  return out;
}

LoadrtMerge::Parameter* find(LoadrtMerge::Module& module, std::string_view key) {
  for (auto& p : module.parameters)
    if (p.key == key) return &p;
  return nullptr;
}

/// A name that two lines give would make the load fail later, without saying which lines.
Status check_names(const LoadrtMerge::Module& module, const LoadrtMerge::Parameter* old,
                   const std::string& more) {
  auto known = old != nullptr ? elements(old->value) : std::vector<std::string_view>{};
  for (const auto name : elements(more)) {
    if (std::find(known.begin(), known.end(), name) != known.end()) {
      return fail(Errc::exists, "loadrt " + module.name + ": the name '" + std::string(name) +
                                    "' is given twice; the others are at " + module.places_text());
    }
    known.push_back(name);
  }
  return {};
}

Status merge_form(LoadrtMerge::Module& module, const LoadrtMerge::Parameter& given) {
  for (const auto& p : module.parameters) {
    if (is_form(p.key) && p.key != given.key) {
      return fail(Errc::bad_argument, "loadrt " + module.name + ": " + given.key + "= here and " +
                                          p.key + "= at " + p.at.text() +
                                          "; a module takes one of count=, num_chan= and names=");
    }
  }
  auto* old = find(module, given.key);
  if (given.key == "names") {
    KERF_CHECK(check_names(module, old, given.value));
    module.instances += elements(given.value).size();
    if (old != nullptr)
      append(old->value, given.value);
    else
      module.parameters.push_back(given);
    return {};
  }
  KERF_TRY(const long more, number(module.name, given));
  module.instances += static_cast<std::size_t>(more);
  if (old == nullptr)
    module.parameters.push_back(given);
  else
    old->value = std::to_string(module.instances);
  return {};
}

/// Personalities belong to instances: those of lines that give none are 0, the default.
Status merge_personality(LoadrtMerge::Module& module, const LoadrtMerge::Parameter* given,
                         std::size_t before, const Place& at) {
  if (given == nullptr && !module.has_personality) return {};
  auto* old = find(module, kPersonality);
  if (old == nullptr) {
    module.parameters.push_back({std::string(kPersonality), repeated("0", before), at});
    old = &module.parameters.back();
  }
  module.has_personality = true;
  const std::size_t own = module.instances - before;
  std::size_t have = 0;
  if (given != nullptr) {
    append(old->value, given->value);
    have = elements(given->value).size();
  }
  if (have < own) append(old->value, repeated("0", own - have));
  return {};
}

}  // namespace

bool LoadrtMerge::takes_list(Module& module, const std::string& key) const {
  if (!module.lists) {
    module.lists = lists_of_(module.name);
    // An unknown module: loadrt says so, and needs no second complaint before.
    if (!module.lists) return true;
  }
  return std::find(module.lists->begin(), module.lists->end(), key) != module.lists->end();
}

Status LoadrtMerge::merge_other(Module& module, const Parameter& given) {
  auto* old = find(module, given.key);
  if (old == nullptr) {
    module.parameters.push_back(given);
  } else if (takes_list(module, given.key)) {
    append(old->value, given.value);
  } else if (old->value != given.value) {
    return fail(Errc::bad_argument, "loadrt " + module.name + ": " + given.key + "=" + given.value +
                                        " here and " + given.key + "=" + old->value + " at " +
                                        old->at.text());
  }
  return {};
}

std::vector<std::string> LoadrtMerge::Module::words() const {
  std::vector<std::string> out{name};
  for (const auto& p : parameters)
    out.push_back(p.key.empty() ? p.value : std::string(p.key).append("=").append(p.value));
  return out;
}

std::string LoadrtMerge::Module::places_text() const {
  std::string out;
  for (const auto& at : places) out += (out.empty() ? "" : ", ") + at.text();
  return out;
}

Status LoadrtMerge::add(std::span<const std::string> words, const Place& at) {
  if (words.empty()) return fail(Errc::bad_argument, "loadrt needs a module");
  auto found = std::find_if(modules_.begin(), modules_.end(),
                            [&](const Module& m) { return m.name == words[0]; });
  if (found == modules_.end()) {
    modules_.emplace_back();
    found = modules_.end() - 1;
    found->name = words[0];
  }
  Module& module = *found;
  const std::size_t before = module.instances;
  std::vector<Parameter> given;
  for (const auto& word : words.subspan(1)) {
    const auto equals = word.find('=');
    if (equals == std::string::npos)
      given.push_back({"", word, at});
    else
      given.push_back({word.substr(0, equals), word.substr(equals + 1), at});
  }
  const Parameter* personality = nullptr;
  for (const auto& p : given) {
    if (is_form(p.key))
      KERF_CHECK(merge_form(module, p));
    else if (p.key == kPersonality)
      personality = &p;
    else
      KERF_CHECK(merge_other(module, p));
  }
  KERF_CHECK(merge_personality(module, personality, before, at));
  module.places.push_back(at);
  return {};
}

bool is_excluded(std::string_view text) {
  static constexpr std::string_view kMagic = "#notwopass";
  std::size_t matched = 0;
  bool line_matches = true;
  for (const char c : text) {
    if (c == '\n') {
      matched = 0;
      line_matches = true;
    } else if (line_matches && c != ' ' && c != '\t' && c != '\r') {
      line_matches = std::tolower(static_cast<unsigned char>(c)) == kMagic[matched];
      if (line_matches && ++matched == kMagic.size()) return true;
    }
  }
  return false;
}

}  // namespace kerf::hal::tcl
