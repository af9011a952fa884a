// liblinuxcncini: the published C functions for programs that read INI files (inifile.h).
#include <inifile.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>

#include "ini/ini_file.hpp"

namespace kerf::ini {
namespace {

/// What stands in an open file. Its name, for what it includes, is as the kernel has it.
std::optional<IniFile> read_open_file(std::FILE* file) {
  if (file == nullptr || std::fseek(file, 0, SEEK_SET) != 0) return std::nullopt;
  std::string text;
  char piece[4096];
  for (std::size_t got = 0; (got = std::fread(piece, 1, sizeof piece, file)) > 0;)
    text.append(piece, got);
  const std::string link = "/proc/self/fd/" + std::to_string(::fileno(file));
  char* name = ::realpath(link.c_str(), nullptr);
  auto loaded = IniFile::parse(text, name != nullptr ? name : "the INI file");
  std::free(name);
  for (const auto& d : loaded.diagnostics)
    if (d.is_error) std::fprintf(stderr, "%s\n", d.message().c_str());
  if (!loaded.ok) return std::nullopt;
  return std::move(loaded.file);
}

std::string_view text_or_any(const char* name) {
  return name == nullptr ? std::string_view() : name;
}

/// As IniFile::ErrorCode of inifile.hh.
enum Why { none = 0, not_open = 1, no_section = 2, no_tag = 4, no_number = 8 };

}  // namespace
}  // namespace kerf::ini

using namespace kerf::ini;  // NOLINT(google-build-using-namespace): the published names

extern "C" {

[[gnu::visibility("default")]] const char* iniFindNth(std::FILE* file, const char* tag,
                                                      const char* section, int num, int* line) {
  if (tag == nullptr || *tag == '\0' || num < 1) return nullptr;
  const auto ini = read_open_file(file);
  if (!ini) return nullptr;
  const Entry* entry = ini->find(text_or_any(section), tag, static_cast<std::size_t>(num));
  if (entry == nullptr) return nullptr;
  if (line != nullptr) *line = entry->at.line;
  static thread_local std::string value;
  value = entry->value;
  return value.c_str();
}

[[gnu::visibility("default")]] const char* iniFind(std::FILE* file, const char* tag,
                                                   const char* section) {
  return iniFindNth(file, tag, section, 1, nullptr);
}

[[gnu::visibility("default")]] int iniHasSection(std::FILE* file, const char* section) {
  const auto ini = read_open_file(file);
  return ini && section != nullptr && ini->has_section(section) ? 1 : 0;
}

}  // extern "C"

namespace {

template <class T, class Parse>
int number(std::FILE* file, const char* tag, const char* section, T* result, Parse&& parse) {
  if (file == nullptr) return not_open;
  const char* text = iniFind(file, tag, section);
  if (text == nullptr)
    return section != nullptr && iniHasSection(file, section) == 0 ? no_section : no_tag;
  char* end = nullptr;
  const T value = parse(text, &end);
  if (end == text || *end != '\0') return no_number;
  *result = value;
  return none;
}

}  // namespace

extern "C" {

[[gnu::visibility("default")]] int iniFindInt(std::FILE* file, const char* tag, const char* section,
                                              int* result) {
  return number(file, tag, section, result, [](const char* text, char** end) {
    const bool hexadecimal = text[0] == '0' && (text[1] == 'x' || text[1] == 'X');
    return static_cast<int>(std::strtol(text, end, hexadecimal ? 16 : 10));
  });
}

[[gnu::visibility("default")]] int iniFindDouble(std::FILE* file, const char* tag,
                                                 const char* section, double* result) {
  return number(file, tag, section, result,
                [](const char* text, char** end) { return std::strtod(text, end); });
}

[[gnu::visibility("default")]] int TildeExpansion(const char* file, char* path, std::size_t size) {
  std::string whole = file;
  if (whole.rfind("~/", 0) == 0) {
    const char* home = std::getenv("HOME");
    if (home == nullptr) return 0;
    whole.replace(0, 1, home);
  }
  if (whole.size() >= size) return 0;
  std::memcpy(path, whole.c_str(), whole.size() + 1);
  return 1;
}

}  // extern "C"
