#include "hal/loader/module_source.hpp"

#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "rtapi/base/suggest.hpp"

namespace kerf::hal {

using rtapi::Errc;
using rtapi::fail;
using rtapi::Result;

namespace {

std::string with(std::string_view name, char from, char to) {
  std::string out(name);
  std::replace(out.begin(), out.end(), from, to);
  return out;
}

/// `or_else`: what to do when no known name is like it.
rtapi::Failure<rtapi::Error> unknown(std::string_view name, const std::vector<std::string>& known,
                                     const char* or_else = "") {
  const std::string like = rtapi::did_you_mean(name, known);
  return fail(Errc::not_found,
              "no component '" + std::string(name) + "'" + (like.empty() ? or_else : like));
}

constexpr const char* kInstall =
    "; halcompile --install puts one of your own where loadrt looks, KERF_COMPONENTS=FOLDER names "
    "more folders";

}  // namespace

DlopenSource::DlopenSource() {
  if (const char* list = std::getenv("KERF_COMPONENTS"); list != nullptr && *list != '\0') {
    std::string_view rest(list);
    while (!rest.empty()) {
      const auto end = std::min(rest.find(':'), rest.size());
      if (end > 0) folders_.emplace_back(rest.substr(0, end));
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
  }
  // Kerf's own come last: a folder of one's own adds to them, and may have another version of one.
  std::error_code error;
  const auto exe = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) return;
  const auto own = (exe.parent_path().parent_path() / "components").string();
  if (std::find(folders_.begin(), folders_.end(), own) == folders_.end()) folders_.push_back(own);
}

DlopenSource::~DlopenSource() {
  for (const auto& [module, handle] : open_) ::dlclose(handle);
}

Result<const Module*> DlopenSource::open(std::string_view name) {
  if (name.empty() || name.find('/') != std::string_view::npos)
    return unknown(name, names(), kInstall);
  for (const auto& folder : folders_) {
    for (const auto& file : {std::string(name), with(name, '_', '-'), with(name, '-', '_')}) {
      const std::string path = std::string(folder).append("/").append(file).append(".so");
      if (::access(path.c_str(), F_OK) != 0) continue;
      void* handle = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
      if (handle == nullptr) {
        const char* why = ::dlerror();
        return fail(Errc::system,
                    std::string(name) + ": dlopen: " + (why != nullptr ? why : "failed"));
      }
      const std::string symbol = std::string(kModuleSymbolPrefix) + with(file, '-', '_');
      const auto* module = static_cast<const Module*>(::dlsym(handle, symbol.c_str()));
      if (module == nullptr && ::dlsym(handle, "rtapi_app_main") != nullptr)
        return open_c(std::string(name), path, handle);
      if (module == nullptr || module->abi != kModuleAbi) {
        ::dlclose(handle);
        return fail(Errc::protocol,
                    path + (module == nullptr ? " is not a Kerf component"
                                              : " was built for another version of Kerf"));
      }
      open_.emplace(module, handle);
      return module;
    }
  }
  return unknown(name, names(), kInstall);
}

Result<const Module*> DlopenSource::open_c(const std::string& name, const std::string& path,
                                           void* handle) {
  // Modules use each other's exported functions (kinematics, families of drivers).
  void* again = ::dlopen(path.c_str(), RTLD_NOW | RTLD_GLOBAL | RTLD_NOLOAD);
  ::dlclose(handle);
  if (again == nullptr) {
    const char* why = ::dlerror();
    return fail(Errc::system, name + ": dlopen: " + (why != nullptr ? why : "failed"));
  }
  auto module = std::make_unique<Module>();
  module->abi = kModuleAbi;
  module->c_library = again;
  open_.emplace(module.get(), again);
  c_modules_.push_back(std::move(module));
  return c_modules_.back().get();
}

void DlopenSource::close(const Module* module) {
  const auto it = open_.find(module);
  if (it == open_.end()) return;
  void* handle = it->second;
  open_.erase(it);
  ::dlclose(handle);
  std::erase_if(c_modules_, [&](const auto& m) { return m.get() == module; });
}

std::vector<std::string> DlopenSource::names() const {
  std::vector<std::string> out;
  for (const auto& folder : folders_) {
    std::error_code error;
    for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end;
         it.increment(error)) {
      if (it->path().extension() == ".so") out.push_back(it->path().stem().string());
    }
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

Result<const Module*> StaticSource::open(std::string_view name) {
  const std::string id = with(name, '-', '_');
  for (const auto& row : table_) {
    if (id == row.id) return row.module;
  }
  return unknown(name, names());
}

std::vector<std::string> StaticSource::names() const {
  std::vector<std::string> out;
  for (const auto& row : table_) out.emplace_back(row.id);
  return out;
}

}  // namespace kerf::hal
