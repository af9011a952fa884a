// Panel: halui on the machine of a soak, and somebody who presses its buttons.
#pragma once

#include <memory>
#include <string>

#include "clients/halui/participant.hpp"
#include "harness/machine.hpp"
#include "soak/programs.hpp"

namespace kerf::soak {

class Panel {
 public:
  /// Text for the INI file: what its MDI buttons do.
  [[nodiscard]] static std::string ini_text();

  /// `machine` must outlive it.
  explicit Panel(harness::Machine& machine);
  ~Panel();
  Panel(const Panel&) = delete;
  Panel& operator=(const Panel&) = delete;

  /// Presses one of the MDI buttons, by turns longer than halui needs to see it, or shorter; gives its name.
  std::string press_mdi(Dice& dice);
  /// Presses any other one.
  std::string press_other(Dice& dice);
  /// Lets go of all buttons and waits until halui has seen it: from then on it asks for nothing new.
  void let_go();

 private:
  void set(const std::string& button, bool on);

  harness::Machine& m_;
  std::unique_ptr<clients::halui::HaluiParticipant> halui_;
  std::string held_;  ///< "": none
};

}  // namespace kerf::soak
