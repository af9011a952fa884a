// HalLink: HAL commands of the launcher, through the same interpreter as halcmd's.
#pragma once

#include <sys/types.h>

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "ini/ini_file.hpp"
#include "launcher/plan.hpp"
#include "launcher/supervised_clock.hpp"
#include "rtapi/base/result.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::launcher {

class HalLink {
 public:
  /// not_found or dead while the realtime host does not answer yet. All references must outlive the link.
  static rtapi::Result<std::unique_ptr<HalLink>> connect(rtapi::Segment& segment,
                                                         SupervisedClock& clock,
                                                         const ini::IniFile& ini);
  ~HalLink();
  HalLink(const HalLink&) = delete;
  HalLink& operator=(const HalLink&) = delete;

  void set_keep_going(bool on);
  /// A file or one command; its errors have been printed with file and line.
  bool run(const HalStep& step);
  /// The HAL files of `steps` together ([HAL]TWOPASS); likewise.
  bool run_two_pass(std::span<const HalStep> steps, const std::string& options);
  /// Commands of the launcher's own.
  rtapi::Status command(const std::vector<std::string>& words);
  /// True when the component is there and says that it is ready.
  [[nodiscard]] bool is_ready(const std::string& component) const;
  /// Components of programs by their process; several of one process with blanks between.
  [[nodiscard]] std::map<pid_t, std::string> user_components() const;
  /// The thread that runs a function, or "".
  [[nodiscard]] std::string thread_of(const std::string& function) const;

 private:
  HalLink() = default;
  bool run_haltcl(const std::vector<std::string>& words, const ini::Position& at);
  struct Parts;  ///< hides the HAL headers
  std::unique_ptr<Parts> parts_;
};

}  // namespace kerf::launcher
