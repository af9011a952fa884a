#include "ini/ini_file.hpp"

#include <cstdlib>
#include <utility>

namespace kerf::ini {

namespace {

std::string index_key(std::string_view section, std::string_view key) {
  std::string out;
  out.reserve(section.size() + key.size() + 1);
  out += section;
  out += '\n';
  out += key;
  return out;
}

}  // namespace

std::string Position::text() const {
  if (file.empty() || line <= 0) return file;
  return file + ':' + std::to_string(line);
}

std::string Diagnostic::message() const {
  std::string out = at.text();
  if (!out.empty()) out += ": ";
  out += is_error ? "error: " : "warning: ";
  return out + text;
}

const std::vector<std::size_t>* IniFile::indices(std::string_view section,
                                                 std::string_view key) const {
  if (section.empty() && key.empty()) return &all_;
  const auto it = index_.find(index_key(section, key));
  return it == index_.end() ? nullptr : &it->second;
}

void IniFile::add(Entry entry) {
  const std::size_t i = entries_.size();
  index_[index_key(entry.section, entry.key)].push_back(i);
  index_[index_key(entry.section, {})].push_back(i);
  index_[index_key({}, entry.key)].push_back(i);
  all_.push_back(i);
  entries_.push_back(std::move(entry));
}

const Entry* IniFile::find(std::string_view section, std::string_view key, std::size_t num) const {
  const auto* hits = indices(section, key);
  if (hits == nullptr || num < 1 || num > hits->size()) return nullptr;
  return &entries_[(*hits)[num - 1]];
}

std::vector<const Entry*> IniFile::find_all(std::string_view section, std::string_view key) const {
  std::vector<const Entry*> out;
  if (const auto* hits = indices(section, key); hits != nullptr) {
    out.reserve(hits->size());
    for (const std::size_t i : *hits) out.push_back(&entries_[i]);
  }
  return out;
}

std::vector<std::string> IniFile::sections() const {
  std::vector<std::string> out;
  out.reserve(sections_.size());
  for (const auto& section : sections_) out.push_back(section.name);
  return out;
}

bool IniFile::has_section(std::string_view section) const {
  for (const auto& known : sections_) {
    if (known.name == section) return true;
  }
  return false;
}

Position IniFile::section_position(std::string_view section) const {
  for (const auto& known : sections_) {
    if (known.name == section) return known.at;
  }
  return {name_, 0};
}

std::string expand_tilde(std::string_view path) {
  if (path.substr(0, 2) != "~/") return std::string(path);
  const char* home = std::getenv("HOME");
  if (home == nullptr) return std::string(path);
  return home + std::string(path.substr(1));
}

}  // namespace kerf::ini
