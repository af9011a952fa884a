#include "hal/loader/c_parameters.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstdlib>
#include <cstring>

#include "rtapi/base/suggest.hpp"

namespace kerf::hal {

using rtapi::Errc;
using rtapi::fail;
using rtapi::Status;

namespace {

/// As rtapi_app.h writes it into the module.
struct Parameter {
  const char* name;
  const char* description;
  void* address;
  unsigned count;
  char type;
};
struct Table {
  unsigned abi;
  const Parameter* begin;
  const Parameter* end;
};
constexpr unsigned kTableAbi = 1;

std::span<const Parameter> parameters(void* library) {
  const auto* table = static_cast<const Table*>(::dlsym(library, "rtapi_module_table"));
  if (table == nullptr || table->abi != kTableAbi || table->begin == nullptr) return {};
  return {table->begin, table->end};
}

/// Stores one value at place `index`. False: the text is not of the type.
bool store(const Parameter& p, unsigned index, const std::string& text,
           std::vector<std::unique_ptr<char[]>>& texts) {
  if (p.type == 's') {
    auto copy = std::make_unique<char[]>(text.size() + 1);
    std::memcpy(copy.get(), text.c_str(), text.size() + 1);
    static_cast<char**>(p.address)[index] = copy.get();
    texts.push_back(std::move(copy));
    return true;
  }
  char* end = nullptr;
  errno = 0;
  const long value = std::strtol(text.c_str(), &end, 0);
  if (text.empty() || *end != '\0' || errno == ERANGE) return false;
  if (p.type == 'l') {
    static_cast<long*>(p.address)[index] = value;
    return true;
  }
  // Bit patterns of unsigned numbers are ints too.
  if (value > static_cast<long>(UINT_MAX) || value < INT_MIN) return false;
  static_cast<int*>(p.address)[index] = static_cast<int>(value);
  return true;
}

Status set(const Parameter& p, const std::string& word, const std::string& text,
           std::vector<std::unique_ptr<char[]>>& texts) {
  if (p.count == 0) {
    if (store(p, 0, text, texts)) return {};
    return fail(Errc::bad_argument, "`" + text + "' invalid for parameter `" + word + "'");
  }
  unsigned index = 0;
  for (std::size_t begin = 0; begin <= text.size(); ++index) {
    const auto end = std::min(text.find(',', begin), text.size());
    if (index >= p.count) {
      return fail(Errc::bad_argument,
                  "`" + word + "' has more than " + std::to_string(p.count) + " values");
    }
    const std::string one = text.substr(begin, end - begin);
    if (!store(p, index, one, texts)) {
      return fail(Errc::bad_argument, std::string("`")
                                          .append(one)
                                          .append("' invalid for parameter `")
                                          .append(word)
                                          .append("'"));
    }
    begin = end + 1;
  }
  return {};
}

}  // namespace

std::vector<CParameter> c_parameters(void* library) {
  std::vector<CParameter> out;
  for (const auto& p : parameters(library)) {
    CParameter& own = out.emplace_back();
    own.name = p.name;
    own.description = p.description == nullptr ? "" : p.description;
    own.elements = p.count;
    own.type = p.type == 's' ? "text" : "number";
    if (p.count > 0) continue;
    if (p.type == 's') {
      const char* text = *static_cast<char**>(p.address);
      own.default_text = text == nullptr ? "" : text;
    } else if (p.type == 'l') {
      own.default_text = std::to_string(*static_cast<long*>(p.address));
    } else {
      own.default_text = std::to_string(*static_cast<int*>(p.address));
    }
  }
  return out;
}

Status set_c_parameters(void* library, std::span<const std::string> words,
                        std::vector<std::unique_ptr<char[]>>& texts) {
  const auto known = parameters(library);
  for (const auto& word : words) {
    const auto equals = word.find('=');
    const std::string name = word.substr(0, equals);
    const Parameter* found = nullptr;
    for (const auto& p : known)
      if (name == p.name) found = &p;
    if (equals == std::string::npos || found == nullptr) {
      std::vector<std::string> names;
      for (const auto& p : known) names.emplace_back(p.name);
      return fail(Errc::bad_argument,
                  "Unknown parameter `" + word + "'" +
                      (equals == std::string::npos ? std::string("; expected NAME=VALUE")
                                                   : rtapi::did_you_mean(name, names)));
    }
    std::string text = word.substr(equals + 1);
    if (text.size() >= 2 && (text.front() == '"' || text.front() == '\'') &&
        text.back() == text.front()) {
      text = text.substr(1, text.size() - 2);
    }
    KERF_CHECK(set(*found, word, text, texts));
  }
  return {};
}

}  // namespace kerf::hal
