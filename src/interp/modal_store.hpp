// ModalStore: what puts a modal state back behind an abort. It has the state and the parameters that mirror it, and no Canon: whoever
// restores through it can start no spindle and set no output, whatever the state says.
#pragma once

#include "interp/modal.hpp"
#include "interp/parameters.hpp"

namespace kerf::interp {

class ModalStore {
 public:
  ModalStore(ModalState& state, ParameterTable& params, double machine_unit_mm)
      : state_(state), params_(params), machine_unit_mm_(machine_unit_mm) {}

  /// As it was, but for what does not outlive a stop: cutter compensation, a spline that was begun.
  void restore(const ModalState& before);
  /// A stop in the midst of G5.2 ... G5.3 ends that block: its first control points are gone.
  void drop_nurbs();

 private:
  ModalState& state_;
  ParameterTable& params_;
  double machine_unit_mm_;
};

}  // namespace kerf::interp
