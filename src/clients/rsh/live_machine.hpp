// The machine of a running instance, for one session.
#pragma once

#include <memory>
#include <string>

#include "clients/common/machine_view.hpp"
#include "clients/rsh/machine.hpp"
#include "ini/ini_file.hpp"
#include "task/api/client.hpp"

namespace kerf::rsh {

/// Answers from the machine's INI file; an empty one knows nothing.
class IniAnswers {
 public:
  IniAnswers() = default;
  /// Reads `path`; a file with errors is an error, since a machine would not run with it.
  [[nodiscard]] static rtapi::Result<IniAnswers> load(const std::string& path);

  [[nodiscard]] std::optional<std::string> value(const std::string& section,
                                                 const std::string& key) const;
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  /// Looks where it is, in the INI file's folder, in [DISPLAY]PROGRAM_PREFIX and in `folder` if that is not empty.
  [[nodiscard]] std::optional<std::string> find_program(const std::string& program,
                                                        const std::string& folder) const;

 private:
  std::string name_;
  ini::IniFile file_;
};

class LiveMachine final : public Machine {
 public:
  /// What is shared must outlive it.
  LiveMachine(clients::MachineView& view, std::unique_ptr<task::Client> client,
              const IniAnswers& ini, std::string program_folder)
      : view_(view),
        client_(std::move(client)),
        ini_(ini),
        program_folder_(std::move(program_folder)) {}

  [[nodiscard]] const clients::Stat& stat() const override { return view_.stat(); }
  void refresh() override { (void)view_.poll(); }
  rtapi::Result<std::uint64_t> send(const std::vector<std::string>& words) override {
    return client_->send(words);
  }
  [[nodiscard]] std::optional<task::Reply> outcome(std::uint64_t id) override;
  void forget(std::uint64_t id) override { client_->forget(id); }
  [[nodiscard]] std::vector<task::OperatorMessage> new_messages() override {
    return client_->new_messages();
  }
  [[nodiscard]] std::optional<std::string> ini(const std::string& section,
                                               const std::string& key) const override {
    return ini_.value(section, key);
  }
  [[nodiscard]] std::string ini_name() const override { return ini_.name(); }
  [[nodiscard]] std::optional<std::string> find_program(const std::string& name) const override {
    return ini_.find_program(name, program_folder_);
  }
  [[nodiscard]] double wall_time_s() const override;

 private:
  clients::MachineView& view_;
  std::unique_ptr<task::Client> client_;
  const IniAnswers& ini_;
  std::string program_folder_;
};

}  // namespace kerf::rsh
