// xyzac-trt-kins: mill with a table that tilts about X and turns about Z (manual: "5-Axis Kinematics").
#include "tilting_table.hpp"

namespace {

using namespace kerf::kinematics;  // NOLINT(google-build-using-namespace): one file, one module

class TrtKins final : public TiltingTable<TrtKins, 'a'> {
 public:
  static constexpr kerf::hal::Info kInfo{
      .name = "xyzac-trt-kins",
      .summary = "Kinematics of a mill with a table that tilts about X and turns about Z",
      .notes =
          "Positions are of the tool on the workpiece, which lies on the turning table. Kind 1 of "
          "motion.switchkins-type is identity: each joint is an axis.",
      .singleton = true};
  explicit TrtKins(kerf::hal::Builder& b) noexcept : TiltingTable(b) {}
};

}  // namespace

KERF_HAL_MODULE(TrtKins)
