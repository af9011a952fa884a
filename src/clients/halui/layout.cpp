#include "clients/halui/layout.hpp"

#include <string>

#include "ini/reader.hpp"
#include "rtapi/base/pose.hpp"

namespace kerf::clients::halui {

using rtapi::Errc;
using rtapi::fail;

rtapi::Result<Layout> read_layout(const ini::IniFile& ini) {
  ini::Reader reader(ini);
  Layout layout;
  layout.joints = static_cast<int>(reader.integer("KINS", "JOINTS"));
  layout.spindles = static_cast<int>(reader.integer("TRAJ", "SPINDLES"));
  for (const char c : reader.string("TRAJ", "COORDINATES"))
    if (const int axis = rtapi::axis_index(c); axis >= 0)
      layout.axis_mask |= 1U << static_cast<unsigned>(axis);
  if (layout.axis_mask == 0)
    reader.complain("TRAJ", "COORDINATES", "no axis named: expected letters such as X Y Z");
  for (int j = 0; j < layout.joints; ++j)
    layout.home_all = layout.home_all || reader.has("JOINT_" + std::to_string(j), "HOME_SEQUENCE");
  layout.mdi_commands = reader.strings("HALUI", "MDI_COMMAND");
  if (layout.mdi_commands.size() > MdiButtons::kMost)
    reader.complain("HALUI", "MDI_COMMAND",
                    "there are " + std::to_string(layout.mdi_commands.size()) +
                        " of them: expected at most " + std::to_string(MdiButtons::kMost));
  std::string complaints;
  for (const ini::Diagnostic& d : reader.complaints())
    if (d.is_error) complaints += (complaints.empty() ? "" : "\n") + d.message();
  if (!complaints.empty()) return fail(Errc::bad_argument, complaints);
  return layout;
}

}  // namespace kerf::clients::halui
