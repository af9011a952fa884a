// The file of a flight record: lines "key: value", an empty line, then the words of both rings and the tables of the screws. @nonrt
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "motion/api/flight_record.hpp"
#include "motion/api/shared.hpp"

namespace kerf::motion {

struct FlightFile {
  static constexpr const char* kMark = "kerf flight record 1";
  /// why, text, ini, kinematics, setp (several, a line each), pin (its type and name, likewise), period-ns, joints ...
  std::multimap<std::string, std::string> head;
  std::vector<std::uint64_t> servo, path;
  std::vector<ScrewTable> screws;  ///< of the joints from 0 on; empty: none has one

  [[nodiscard]] std::string text(const std::string& key) const {
    const auto at = head.find(key);
    return at == head.end() ? std::string() : at->second;
  }
  [[nodiscard]] long long number(const std::string& key) const {
    const std::string value = text(key);
    return value.empty() ? 0 : std::strtoll(value.c_str(), nullptr, 0);
  }
  void set(const std::string& key, const std::string& value) {
    std::string line = value;
    for (char& c : line)
      if (c == '\n') c = ' ';
    head.emplace(key, line);
  }
  /// All of it that is in the block now.
  void take(FlightRecord& record, const MotionShared& shared) {
    set("abi", std::to_string(kFlightAbi));
    set("state-abi", std::to_string(record.state_abi));
    set("period-ns", std::to_string(record.period_ns));
    set("joints", std::to_string(record.joints));
    set("spindles", std::to_string(record.spindles));
    set("extra-joints", std::to_string(record.extra_joints));
    set("digital", std::to_string(record.digital));
    set("analog", std::to_string(record.analog));
    const std::size_t pins = std::min<std::size_t>(record.pin_count.observe(), kMaxRecordedPins);
    for (std::size_t i = 0; i < pins; ++i)
      set("pin", std::to_string(record.pin[i].type) + " " + std::string(record.pin[i].name.view()));
    const std::size_t words = std::min<std::size_t>(record.servo_words, FlightRecord::kServoWords);
    // The path last: what the planner took before a recorded cycle is then there; what it took later is left out.
    servo = record.servo(words).copy();
    path = record.path(words).copy();
    set("path-lost", record.path(words).lost() ? "1" : "0");
    // Task writes them before it has the machine's first limits, so they are the same in the whole record.
    screws.assign(kMaxJoints, ScrewTable{});
    bool any = false;
    for (std::size_t j = 0; j < kMaxJoints; ++j)
      any = (shared.screw[j].read(screws[j]) && screws[j].count > 0) || any;
    if (!any) screws.clear();
  }

  /// False: the file cannot be written.
  [[nodiscard]] bool write(std::FILE* out) const {
    std::string text = std::string(kMark) + "\n";
    for (const auto& [key, value] : head) text.append(key).append(": ").append(value).append("\n");
    text += "servo-words: " + std::to_string(servo.size()) +
            "\npath-words: " + std::to_string(path.size()) +
            "\nscrews: " + std::to_string(screws.size()) + "\n\n";
    return std::fwrite(text.data(), 1, text.size(), out) == text.size() &&
           std::fwrite(servo.data(), 8, servo.size(), out) == servo.size() &&
           std::fwrite(path.data(), 8, path.size(), out) == path.size() &&
           std::fwrite(screws.data(), sizeof(ScrewTable), screws.size(), out) == screws.size() &&
           std::fflush(out) == 0;
  }
  /// "" or what is wrong with it.
  [[nodiscard]] std::string read(std::FILE* in) {
    std::string line;
    const auto next = [&] {
      line.clear();
      for (int c = std::fgetc(in); c != '\n'; c = std::fgetc(in)) {
        if (c == EOF || line.size() > 4096) return false;
        line += static_cast<char>(c);
      }
      return true;
    };
    if (!next() || line != kMark) return "this is no flight record";
    while (next() && !line.empty()) {
      const auto colon = line.find(": ");
      if (colon == std::string::npos) return "its head is damaged at '" + line + "'";
      head.emplace(line.substr(0, colon), line.substr(colon + 2));
    }
    constexpr long long kMost = 1LL << 26;
    const long long a = number("servo-words"), b = number("path-words"), c = number("screws");
    if (a < 0 || b < 0 || a > kMost || b > kMost ||
        (c != 0 && c != static_cast<long long>(kMaxJoints)))
      return "its head is damaged: servo-words, path-words, screws";
    servo.resize(static_cast<std::size_t>(a));
    path.resize(static_cast<std::size_t>(b));
    screws.resize(static_cast<std::size_t>(c));
    if (std::fread(servo.data(), 8, servo.size(), in) != servo.size() ||
        std::fread(path.data(), 8, path.size(), in) != path.size() ||
        std::fread(screws.data(), sizeof(ScrewTable), screws.size(), in) != screws.size())
      return "it ends in the middle; it was not written whole";
    if (text("abi") != std::to_string(kFlightAbi)) return "another build of Kerf has written it";
    return {};
  }
};

}  // namespace kerf::motion
