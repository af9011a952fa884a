// ToolTable: the tool file of a machine (manual: "Tool Table Format").
//
//   T1 P17 X0 Y0 Z12.5 D6 I0 J0 Q0 ;6 mm end mill
//
// One tool a line: T (number) and P (pocket) are required; X..W offsets and D diameter in machine units, I front and J back
// angle in degrees, Q orientation 0-9, and a remark behind ';'. Lines that hold no tool (blank, or beginning with ';') are
// kept where they are, remarks too. There is no limit to the number of tools.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "rtapi/base/pose.hpp"
#include "rtapi/base/result.hpp"

namespace kerf::io {

/// One tool. Lengths in mm and degrees here, whatever the file's unit.
struct ToolEntry {
  int number{0};
  int pocket{0};
  rtapi::Pose offset{};
  double diameter_mm{0};
  double front_angle_deg{0};
  double back_angle_deg{0};
  int orientation{0};
  std::string remark;  ///< text behind ';', as written

  friend bool operator==(const ToolEntry&, const ToolEntry&) = default;
};

/// A value: copy it to hand it to another thread.
class ToolTable {
 public:
  static constexpr int kMaxPocket = 1000;  ///< of a random changer; on others P is the user's own

  /// `unit_mm`: mm in one machine unit. Every complaint of the file stands in one error, a line each, with file and line.
  /// `random`: for a random changer, where no two tools can be in one pocket; on others P is the user's own.
  [[nodiscard]] static rtapi::Result<ToolTable> parse(std::string_view text,
                                                      const std::string& file, double unit_mm,
                                                      bool random = false);
  /// not_found, system, or syntax as parse().
  [[nodiscard]] static rtapi::Result<ToolTable> load(const std::string& file, double unit_mm,
                                                     bool random = false);

  /// What save() writes; parse() of it gives the same table.
  [[nodiscard]] std::string text(double unit_mm) const;
  /// Whole or not at all: a temporary file beside it is written, synced and renamed; mode and owner's bits are kept.
  [[nodiscard]] rtapi::Status save(const std::string& file, double unit_mm) const;

  /// Tools in file order. The index in it is what `iocontrol.0.tool-prep-index` shows, from 1, on non-random changers.
  [[nodiscard]] const std::vector<ToolEntry>& tools() const noexcept { return tools_; }
  [[nodiscard]] const ToolEntry* find(int number) const noexcept;
  [[nodiscard]] const ToolEntry* find_pocket(int pocket) const noexcept;
  /// Position of a tool in tools(), or -1.
  [[nodiscard]] int index_of(int number) const noexcept;
  /// Lines of the file that have no effect, each with file and line.
  [[nodiscard]] const std::vector<std::string>& warnings() const noexcept { return warnings_; }
  /// Replaces the tool of that number or adds it at the end; an empty remark keeps the old one.
  void put(const ToolEntry& entry);
  /// Moves a tool to a pocket (random changers after M6); nothing for a number that is not in the table.
  void set_pocket(int number, int pocket) noexcept;

  friend bool operator==(const ToolTable& a, const ToolTable& b) {
    return a.tools_ == b.tools_ && a.lines_ == b.lines_;
  }

 private:
  struct Line {
    int tool{-1};  ///< index in tools_, or -1: `text` as it was
    std::string text;
    friend bool operator==(const Line&, const Line&) = default;
  };
  std::vector<ToolEntry> tools_;
  std::vector<Line> lines_;
  std::vector<std::string> warnings_;
};

/// Writes `text` to `file` whole or not at all: temporary file in the same folder, fsync, rename, fsync of the folder. A symbolic link
/// stays a link. Used for every file that outlives the power.
[[nodiscard]] rtapi::Status write_file_whole(const std::string& file, std::string_view text);
/// The whole file. not_found or system.
[[nodiscard]] rtapi::Result<std::string> read_file(const std::string& file);

}  // namespace kerf::io
