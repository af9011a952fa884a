#include "interp/parameters.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>

namespace kerf::interp {

namespace {

using rtapi::Errc;
using rtapi::fail;

struct Range {
  int first, last;
};
// Manual, "Numbered Parameters": what keeps its value without power.
constexpr Range kPersistent[] = {
    {5161, 5169}, {5181, 5189}, {5210, 5220}, {5221, 5230}, {5241, 5250}, {5261, 5270},
    {5281, 5290}, {5301, 5310}, {5321, 5330}, {5341, 5350}, {5361, 5370}, {5381, 5390},
};

}  // namespace

ParameterTable::ParameterTable() : numbers_(kParameterCount, 0.0) {
  numbers_[kCoordSystem] = 1;
  numbers_[kDebugEnable] = 1;
}

bool ParameterTable::persistent(int index) noexcept {
  return std::any_of(std::begin(kPersistent), std::end(kPersistent),
                     [index](const Range& r) { return index >= r.first && index <= r.last; });
}

void ParameterTable::set(int index, double value) {
  if (index <= 0 || index >= kParameterCount) return;
  double& cell = numbers_[static_cast<std::size_t>(index)];
  undo_numbers_.emplace_back(index, cell);
  cell = value;
  if (!number_texts_.empty()) change_text(index, nullptr);
}

void ParameterTable::set_text(int index, std::shared_ptr<const std::string> text) {
  set(index, 0);
  change_text(index, std::move(text));
}

void ParameterTable::change_text(int index, std::shared_ptr<const std::string> text) {
  undo_texts_.emplace_back(index, this->text(index));
  if (text != nullptr)
    number_texts_[index] = std::move(text);
  else
    number_texts_.erase(index);
}

std::array<double, kSubArguments> ParameterTable::exchange_arguments(
    const std::array<double, kSubArguments>& fresh) {
  std::array<double, kSubArguments> before{};
  std::copy_n(numbers_.begin() + 1, kSubArguments, before.begin());
  std::copy_n(fresh.begin(), kSubArguments, numbers_.begin() + 1);
  begin();
  return before;
}

Pose ParameterTable::pose(int first, double unit_mm) const noexcept {
  Pose p;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    p[i] = get(first + static_cast<int>(i)) * (rtapi::is_rotary(i) ? 1.0 : unit_mm);
  return p;
}

void ParameterTable::set_pose(int first, const Pose& pose, double unit_mm) {
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    set(first + static_cast<int>(i), rtapi::is_rotary(i) ? pose[i] : pose[i] / unit_mm);
}

std::uint32_t ParameterTable::intern(std::string_view name) {
  const std::uint32_t id = texts_.intern(name);
  if (id == names_.size()) names_.emplace_back().global = !name.empty() && name.front() == '_';
  return id;
}

std::vector<std::string_view> ParameterTable::visible_names() const {
  std::vector<std::string_view> names;
  for (std::uint32_t id = 0; id < names_.size(); ++id) {
    if (find(id) != nullptr) names.emplace_back(texts_.text(id));
  }
  return names;
}

ParameterTable::Slot ParameterTable::slot(std::uint32_t id) {
  Name& n = names_[id];
  if (n.global) return {&n.set, &n.value};
  if (n.local < scopes_.back()) {
    locals_.push_back({id, false, n.local, {}});
    n.local = static_cast<std::int64_t>(locals_.size()) - 1;
  }
  Local& local = locals_[static_cast<std::size_t>(n.local)];
  return {&local.set, &local.value};
}

void ParameterTable::set_named(std::uint32_t id, Value value) {
  const Slot s = slot(id);
  undo_named_.push_back({id, *s.set, *s.value});
  *s.set = true;
  *s.value = std::move(value);
}

void ParameterTable::push_scope() { scopes_.push_back(static_cast<std::int64_t>(locals_.size())); }

void ParameterTable::pop_scope() {
  if (scopes_.size() == 1) return;
  while (static_cast<std::int64_t>(locals_.size()) > scopes_.back()) {
    names_[locals_.back().id].local = locals_.back().hidden;
    locals_.pop_back();
  }
  scopes_.pop_back();
}

void ParameterTable::rollback() {
  for (auto i = undo_numbers_.rbegin(); i != undo_numbers_.rend(); ++i)
    numbers_[static_cast<std::size_t>(i->first)] = i->second;
  for (auto i = undo_texts_.rbegin(); i != undo_texts_.rend(); ++i) {
    if (i->second != nullptr)
      number_texts_[i->first] = i->second;
    else
      number_texts_.erase(i->first);
  }
  for (auto i = undo_named_.rbegin(); i != undo_named_.rend(); ++i) {
    const Slot s = slot(i->id);
    *s.set = i->set;
    *s.value = i->value;
  }
  begin();
}

rtapi::Status ParameterFile::load(ParameterTable& table) const {
  std::FILE* file = std::fopen(path_.c_str(), "re");
  if (file == nullptr)
    return fail(errno == ENOENT ? Errc::not_found : Errc::system,
                std::string("Unable to open file <") + path_ + ">: " + std::strerror(errno));
  char line[512];
  std::int32_t number = 0, before = 0;
  rtapi::Status status;
  table.extra_persistent_.clear();
  while (std::fgets(line, sizeof line, file) != nullptr) {
    ++number;
    double index = 0, value = 0;
    char rest[2];
    if (std::sscanf(line, "%lf %lf %1s", &index, &value, rest) != 2) continue;
    const rtapi::SourcePos at{rtapi::FixedString<160>(path_), number, 0};
    if (index < 1 || index >= kParameterCount || index != static_cast<int>(index)) {
      status = fail(Errc::syntax, "Parameter number out of range; 1 to 5602 are possible", at);
      break;
    }
    const int i = static_cast<int>(index);
    if (i <= before) {
      status = fail(Errc::syntax, "Parameter file out of order; numbers must ascend", at);
      break;
    }
    if (!std::isfinite(value)) {
      status = fail(Errc::syntax, "Parameter value is no finite number", at);
      break;
    }
    before = i;
    table.set(i, value);
    if (!ParameterTable::persistent(i)) table.extra_persistent_.push_back(i);
  }
  // A directory opens like a file and reads like none.
  if (status.ok() && std::ferror(file) != 0)
    status = fail(Errc::system, "Unable to read file <" + path_ + ">: " + std::strerror(errno));
  std::fclose(file);
  table.begin();
  const double system = table.get(kCoordSystem);
  if (status.ok() && !(system >= 1 && system <= 9)) table.set(kCoordSystem, 1);
  return status;
}

std::string ParameterFile::text(const ParameterTable& table) {
  std::vector<std::int32_t> keep = table.extra_persistent_;
  for (const Range& r : kPersistent) {
    for (int i = r.first; i <= r.last; ++i) keep.push_back(i);
  }
  std::sort(keep.begin(), keep.end());
  std::string out;
  char line[64];
  for (const std::int32_t i : keep) {
    std::snprintf(line, sizeof line, "%d\t%.6f\n", i, table.get(i));
    out += line;
  }
  return out;
}

bool ParameterFile::holds(const std::string& content) const {
  std::FILE* file = std::fopen(path_.c_str(), "re");
  if (file == nullptr) return false;
  // One byte more, so that a longer file differs.
  std::string there(content.size() + 1, '\0');
  there.resize(std::fread(there.data(), 1, there.size(), file));
  const bool read = std::ferror(file) == 0;
  std::fclose(file);
  return read && there == content;
}

rtapi::Status ParameterFile::save(const ParameterTable& table) const {
  const std::string content = text(table);
  if (holds(content)) return {};
  const std::string fresh = path_ + ".new";
  const auto problem = [&](const char* what) {
    const std::string message = std::string(what) + " " + fresh + ": " + std::strerror(errno);
    ::unlink(fresh.c_str());
    return fail(Errc::system, message);
  };
  const int fd = ::open(fresh.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (fd < 0) return problem("cannot create");
  std::size_t done = 0;
  while (done < content.size()) {
    const ssize_t n = ::write(fd, content.data() + done, content.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      ::close(fd);
      return problem("cannot write");
    }
    done += static_cast<std::size_t>(n);
  }
  if (::fsync(fd) != 0 || ::close(fd) != 0) return problem("cannot write");
  const std::string backup = path_ + ".bak";
  ::unlink(backup.c_str());
  // A second name for the old content; the path itself is never missing.
  if (::link(path_.c_str(), backup.c_str()) != 0 && errno != ENOENT && errno != EPERM)
    return problem("cannot keep a backup of");
  if (::rename(fresh.c_str(), path_.c_str()) != 0) return problem("cannot replace the file by");
  const std::size_t slash = path_.rfind('/');
  const std::string dir = slash == std::string::npos ? "." : path_.substr(0, slash + 1);
  const int dir_fd = ::open(dir.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (dir_fd >= 0) {
    ::fsync(dir_fd);
    ::close(dir_fd);
  }
  return {};
}

}  // namespace kerf::interp
