// CoreSelf: what functions of a ScriptHost see and change of an interpreter.
#pragma once

#include "interp/core.hpp"
#include "interp/script.hpp"

namespace kerf::interp {

class CoreSelf final : public ScriptSelf {
 public:
  explicit CoreSelf(Core& core) : c_(core) {}
  std::optional<ScriptNumber> number(std::string_view name, int index) override;
  bool set_number(std::string_view name, int index, double value) override;
  std::optional<std::string> text(std::string_view name) override;
  std::vector<std::string_view> names() override;
  std::optional<double> parameter(int index) override;
  bool set_parameter(int index, double value) override;
  std::optional<double> parameter(std::string_view name) override;
  bool set_parameter(std::string_view name, double value) override;
  std::vector<std::string> parameter_names() override;
  std::optional<double> word(int level, char letter) override;
  std::string block_text(int level, std::string_view what) override;
  std::optional<ScriptNumber> block_number(int level, std::string_view what, int index) override;
  std::optional<std::string> call_text(int level, std::string_view what) override;
  std::optional<ScriptTool> tool(int number) override;
  ScriptTool tool_in_spindle() override;
  std::string canon(std::string_view name, const std::vector<ScriptArgument>& arguments) override;
  std::vector<std::string_view> canon_names() override;
  std::string glue(std::string_view function) override;
  void set_error(std::string text) override { error_ = std::move(text); }
  std::string error_text() override { return error_; }

 private:
  [[nodiscard]] const RemapCall* block_of(int level) const;
  [[nodiscard]] ScriptTool script_tool(const Tool& tool) const;

  Core& c_;
  std::string error_;
};

}  // namespace kerf::interp
