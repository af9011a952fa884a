// gantry: one axis with several motors that home on their own.
#include "hal/component.hpp"

namespace kerf::components {

class Gantry final : public hal::Component<Gantry> {
 public:
  static constexpr hal::Info kInfo{
      .name = "gantry",
      .summary = "One axis with several motors that home on their own",
      .notes =
          "personality= is the number of joints, 2 to 7. All joints follow the command; while the "
          "axis moves towards the home switches, a joint whose switch is closed stands and its "
          "offset grows, until all are closed."};

  explicit Gantry(hal::Builder& b) noexcept : Component(b) {
    const std::int64_t joints = b.personality() > 0 ? b.personality() : 7;
    if (joints > 7) {
      b.fail("personality= must be from 2 to 7");
      return;
    }
    joints_ = hal::make_array<Joint>(b, static_cast<std::size_t>(joints));
  }

 private:
  struct Joint {
    Joint(hal::Builder& b, std::size_t index) noexcept {
      const auto name = [&](const char* suffix) {
        hal::Name out = hal::numbered("joint.##", index);
        out.append(suffix);
        return b.full_name(out);
      };
      pos_cmd.declare(b, name(".pos-cmd"), "Commanded position of the joint");
      pos_fb.declare(b, name(".pos-fb"), "Position of the joint");
      home.declare(b, name(".home"), "Home switch of the joint");
      offset.declare(b, name(".offset"), "Offset of the joint, found while homing");
    }
    hal::Out<double> pos_cmd, offset;
    hal::In<double> pos_fb;
    hal::In<bool> home;
  };
  std::size_t shown_{0};
  bool homed_{false};
  double before_{0.0};

  hal::In<double> position_cmd_{
      pin<hal::In<double>>("position-cmd", "Commanded position, from motion")};
  hal::Out<double> position_fb_{pin<hal::Out<double>>("position-fb", "Position, for motion")};
  hal::Out<bool> home_{
      pin<hal::Out<bool>>("home", "True from all home switches being closed until all are open")};
  hal::Out<bool> limit_{pin<hal::Out<bool>>("limit", "True while any home switch is closed")};
  hal::In<double> search_vel_{pin<hal::In<double>>(
      "search-vel", "HOME_SEARCH_VEL of the INI file; its sign is the direction of the switches")};
  hal::Array<Joint> joints_;

  void read(const hal::Period&) noexcept {
    bool all = true, any = false;
    for (const Joint& j : joints_) {
      all = all && j.home;
      any = any || j.home;
    }
    // Homed when all switches have closed, until all have opened.
    homed_ = all || (homed_ && any);
    home_ = homed_;
    limit_ = any;
    // The joint that still follows while others stand at their switches.
    if (any && !homed_ && joints_[shown_].home) {
      for (std::size_t i = 0; i < joints_.size(); ++i) {
        if (!joints_[i].home) {
          shown_ = i;
          break;
        }
      }
    }
    if (joints_.size() > 0) position_fb_ = joints_[shown_].pos_fb + joints_[shown_].offset.last();
  }
  hal::Function read_{function<&Gantry::read>("read", "Computes position-fb, home and limit")};

  void write(const hal::Period&) noexcept {
    const double command = position_cmd_, moved = command - before_;
    before_ = command;
    const bool homing = !homed_ && moved * search_vel_ > 0.0;
    for (Joint& j : joints_) {
      if (homing && j.home) j.offset = j.offset.last() + moved;
      j.pos_cmd = command - j.offset.last();
    }
  }
  hal::Function write_{function<&Gantry::write>("write", "Computes the commands of the joints")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Gantry)
