#include "interp/modal.hpp"

namespace kerf::interp {

std::array<std::int32_t, 17> ModalState::active_g_codes() const noexcept {
  constexpr std::int32_t kSystems[10] = {540, 540, 550, 560, 570, 580, 590, 591, 592, 593};
  std::array<std::int32_t, 17> g{};
  g.fill(-1);
  g[0] = line;
  g[1] = motion;
  g[3] = plane_code;
  g[4] = cutter_comp;
  g[5] = units == Units::inch ? 200 : 210;
  g[6] = distance == DistanceMode::absolute ? 900 : 910;
  g[7] = feed_mode == ProgramFeedMode::inverse_time ? 930
         : feed_mode == ProgramFeedMode::per_minute ? 940
                                                    : 950;
  g[8] = kSystems[coord_system >= 1 && coord_system <= 9 ? coord_system : 1];
  g[9] = tool_offset_code;
  g[10] = retract == RetractMode::old_z ? 980 : 990;
  g[11] = path == PathMode::exact_path ? 610 : path == PathMode::exact_stop ? 611 : 640;
  g[13] = css[0] ? 960 : 970;
  g[14] = arc_distance == DistanceMode::absolute ? 901 : 911;
  g[15] = lathe_diameter ? 70 : 80;
  g[16] = g92_applied ? 923 : 922;
  return g;
}

std::array<std::int32_t, 10> ModalState::active_m_codes() const noexcept {
  std::array<std::int32_t, 10> m{};
  m.fill(-1);
  m[0] = line;
  m[1] = last_stop;
  m[2] = orienting[0]                                         ? 19
         : direction[0] == SpindleDirection::clockwise        ? 3
         : direction[0] == SpindleDirection::counterclockwise ? 4
                                                              : 5;
  m[3] = tool_change;
  m[4] = mist ? 7 : flood ? -1 : 9;
  m[5] = flood ? 8 : -1;
  m[6] = feed_override ? (speed_override[0] ? 48 : 50) : speed_override[0] ? 51 : 49;
  m[7] = adaptive_feed ? 52 : -1;
  m[8] = feed_hold ? 53 : -1;
  m[9] = 0;
  return m;
}

std::array<double, 5> ModalState::settings() const noexcept {
  return {static_cast<double>(line), feed_word, speed_rpm[0], tolerance_mm / unit_mm(),
          naivecam_tolerance_mm / unit_mm()};
}

}  // namespace kerf::interp
