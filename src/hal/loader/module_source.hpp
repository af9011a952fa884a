// Where loadrt finds components: shared objects on disk, or a table linked into the program (the whole-machine harness).
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hal/component.hpp"
#include "rtapi/base/result.hpp"

namespace kerf::hal {

class ModuleSource {
 public:
  virtual ~ModuleSource() = default;
  /// not_found names the nearest component. '-' and '_' in the name stand for each other.
  virtual rtapi::Result<const Module*> open(std::string_view name) = 0;
  /// Ends one open(). No code or object of the module may be in use.
  virtual void close(const Module* module) = 0;
  /// What could be opened.
  [[nodiscard]] virtual std::vector<std::string> names() const = 0;
};

/// NAME.so, a component of ours or a module of the C API, in the folders of KERF_COMPONENTS (':' between them), then in "../components" seen from the program's folder.
class DlopenSource final : public ModuleSource {
 public:
  DlopenSource();
  explicit DlopenSource(std::vector<std::string> folders) : folders_(std::move(folders)) {}
  ~DlopenSource() override;
  DlopenSource(const DlopenSource&) = delete;
  DlopenSource& operator=(const DlopenSource&) = delete;
  rtapi::Result<const Module*> open(std::string_view name) override;
  void close(const Module* module) override;
  [[nodiscard]] std::vector<std::string> names() const override;

 private:
  std::vector<std::string> folders_;
  /// A library with rtapi_app_main: known to later ones by its exported symbols.
  rtapi::Result<const Module*> open_c(const std::string& name, const std::string& path,
                                      void* handle);
  std::multimap<const Module*, void*> open_;
  std::vector<std::unique_ptr<Module>> c_modules_;
};

struct StaticModule {
  const char* id;  ///< file name with '_' for '-'
  const Module* module;
};

/// All components linked into this program: made by kerf_add_static_components() in CMake.
std::span<const StaticModule> static_components();

class StaticSource final : public ModuleSource {
 public:
  explicit StaticSource(std::span<const StaticModule> table) : table_(table) {}
  rtapi::Result<const Module*> open(std::string_view name) override;
  void close(const Module* /*module*/) override {}
  [[nodiscard]] std::vector<std::string> names() const override;

 private:
  std::span<const StaticModule> table_;
};

}  // namespace kerf::hal
