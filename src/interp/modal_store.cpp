#include "interp/modal_store.hpp"

namespace kerf::interp {

void ModalStore::drop_nurbs() {
  if (state_.nurbs_points == 0) return;
  state_.nurbs_points = 0;
  state_.motion = -1;
}

void ModalStore::restore(const ModalState& before) {
  const bool percent = state_.percent_file;
  state_ = before;
  state_.percent_file = percent;
  drop_nurbs();
  // The tool no longer stands beside a path.
  state_.cutter_comp = 400;
  params_.begin();
  params_.set(kCoordSystem, before.coord_system);
  params_.set(kG92Applied, before.g92_applied ? 1 : 0);
  if (before.g92_applied) params_.set_pose(kG92Offset, before.frame.g92(), machine_unit_mm_);
  const int base = kG5xOffset + 20 * (before.coord_system - 1);
  params_.set_pose(base, before.frame.g5x(), machine_unit_mm_);
  params_.set(base + 9, before.frame.rotation_deg());
  params_.begin();
}

}  // namespace kerf::interp
