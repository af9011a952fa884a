// ohmic: ohmic sensing with a THCAD card.
#include "hal/component.hpp"

namespace kerf::components {

class Ohmic final : public hal::Component<Ohmic> {
 public:
  static constexpr hal::Info kInfo{
      .name = "ohmic",
      .summary = "Ohmic sensing with a THCAD card",
      .notes =
          "The frequency from the card is made a voltage. While is-probing is true, ohmic-on tells "
          "whether it is above ohmic-threshold; else ohmic-on stays until it is below ohmic-low."};
  using Component::Component;

 private:
  hal::In<double> zero_freq_{
      pin<hal::In<double>>("thcad-0-volt-freq", "Frequency of the card at 0 V [Hz]")};
  hal::In<double> full_freq_{
      pin<hal::In<double>>("thcad-max-volt-freq", "Frequency of the card at full scale [Hz]")};
  hal::In<double> thcad_divide_{
      pin<hal::In<double>>("thcad-divide", "Divider set on the card", 32)};
  hal::In<double> thcad_fullscale_{
      pin<hal::In<double>>("thcad-fullscale", "Full scale of the card [V]", 5)};
  hal::In<double> velocity_in_{
      pin<hal::In<double>>("velocity-in", "Frequency measured by the encoder input [Hz]")};
  hal::In<double> volt_divider_{
      pin<hal::In<double>>("volt-divider", "Voltage at the torch for one volt at the card", 4.9)};
  hal::In<double> ohmic_threshold_{pin<hal::In<double>>(
      "ohmic-threshold", "Voltage above which ohmic-on becomes true [V]", 22.0)};
  hal::In<double> ohmic_low_{
      pin<hal::In<double>>("ohmic-low", "Voltage below which ohmic-on becomes false [V]", 21.0)};
  hal::Out<bool> arc_on_{pin<hal::Out<bool>>("arc-on", "True while the card is at full scale")};
  hal::Out<double> thcad_volts_{pin<hal::Out<double>>("thcad-volts", "Voltage at the card [V]")};
  hal::Out<double> ohmic_volts_{pin<hal::Out<double>>("ohmic-volts", "Voltage at the torch [V]")};
  hal::Out<bool> ohmic_on_{pin<hal::Out<bool>>("ohmic-on", "True while contact is sensed")};
  hal::In<bool> is_probing_{pin<hal::In<bool>>("is-probing", "True while the machine probes")};

  void update(const hal::Period&) noexcept {
    const double zero = zero_freq_ / thcad_divide_, full = full_freq_ / thcad_divide_;
    const double range = full - zero;
    const double volts = range != 0.0 ? (velocity_in_ - zero) * thcad_fullscale_ / range : 0.0;
    const double at_torch = volts * volt_divider_;
    thcad_volts_ = volts;
    ohmic_volts_ = at_torch;
    arc_on_ = volts >= thcad_fullscale_;
    if (is_probing_)
      ohmic_on_ = at_torch > ohmic_threshold_;
    else if (at_torch < ohmic_low_)
      ohmic_on_ = false;
  }
  hal::Function update_{function<&Ohmic::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Ohmic)
