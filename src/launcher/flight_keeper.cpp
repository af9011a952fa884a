#include "launcher/flight_keeper.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>

#include "hal/core/view.hpp"
#include "ini/ini_file.hpp"
#include "launcher/options.hpp"
#include "motion/api/faults.hpp"
#include "motion/api/flight_file.hpp"
#include "rtapi/sync/patient_read.hpp"
#include "task/api/status.hpp"

namespace kerf::launcher {

namespace fs = std::filesystem;
using rtapi::Errc;
using rtapi::fail;

namespace {

constexpr const char* kEnding = ".flight";

/// "0007-following-error.flight": the number, or 0.
int number_of(const fs::path& path) {
  if (path.extension() != kEnding) return 0;
  return std::atoi(path.filename().c_str());
}

std::vector<fs::path> records_in(const std::string& folder) {
  std::vector<fs::path> out;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (number_of(entry.path()) > 0) out.push_back(entry.path());
  std::sort(out.begin(), out.end(),
            [](const fs::path& a, const fs::path& b) { return number_of(a) < number_of(b); });
  return out;
}

rtapi::Status write_whole(const motion::FlightFile& file, const std::string& path) {
  const std::string draft = path + ".tmp";
  std::FILE* out = std::fopen(draft.c_str(), "we");
  if (out == nullptr)
    return fail(Errc::system, "cannot write " + draft + ": " + std::strerror(errno));
  bool good = file.write(out) && fsync(fileno(out)) == 0;
  good = std::fclose(out) == 0 && good;
  if (good && std::rename(draft.c_str(), path.c_str()) == 0) return {};
  const std::string why = std::strerror(errno);
  (void)std::remove(draft.c_str());
  return fail(Errc::system, "cannot write " + path + ": " + why);
}

void remove_old(const std::string& folder, std::size_t keep) {
  const auto all = records_in(folder);
  std::error_code error;
  for (std::size_t i = 0; i + keep < all.size(); ++i) fs::remove(all[i], error);
}

int usage(int code) {
  std::fputs(
      "usage: kerf record dump FILE [--instance NAME]  the last minute of a running machine, into "
      "FILE\n"
      "       kerf record show FILE [SECONDS]          prints a record, the last SECONDS of it "
      "(default 60)\n"
      "       kerf replay FILE                         runs a record again: exit 0 when all comes "
      "out the same\n",
      code == 0 ? stdout : stderr);
  return code;
}

int run_tool(const std::string& bin, std::vector<std::string> words) {
  words.insert(words.begin(), bin + "/motion-replay");
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  execv(argv[0], argv.data());
  std::fprintf(stderr, "kerf: %s: %s\n", argv[0], std::strerror(errno));
  return kExitFailure;
}

/// What HAL files have set of the kinematics: a replay loads the module anew.
void add_kinematics_values(const rtapi::Segment& segment, motion::FlightFile& file) {
  const std::string words = file.text("kinematics");
  const std::string module = words.substr(0, words.find(' '));
  const hal::View view(segment);
  if (module.empty() || !view.attached()) return;
  const auto add = [&](const std::vector<hal::ItemInfo>& items, hal::Dir dir) {
    for (const hal::ItemInfo& item : items)
      if (item.owner == module && item.dir == dir)
        if (const auto value = view.value(item.name); value.ok())
          file.set("setp", std::string(item.name).append(" ").append(*value));
  };
  add(view.pins(), hal::Dir::in);
  add(view.params(), hal::Dir::rw);
}

int dump(const std::string& instance, const std::string& path) {
  auto segment = rtapi::Segment::attach(instance);
  if (!segment.ok()) {
    std::fprintf(stderr, "kerf: %s\n", segment.error().message().c_str());
    return kExitFailure;
  }
  auto record =
      hal::View(**segment).block<motion::FlightRecord>(motion::kFlightBlock, motion::kFlightAbi);
  if (!record.ok()) {
    std::fprintf(stderr, "kerf: instance '%s' has no motion controller: %s\n", instance.c_str(),
                 record.error().message().c_str());
    return kExitFailure;
  }
  auto shared =
      hal::View(**segment).block<motion::MotionShared>(motion::kMotionBlock, motion::kMotionAbi);
  if (!shared.ok()) {
    std::fprintf(stderr, "kerf: %s\n", shared.error().message().c_str());
    return kExitFailure;
  }
  motion::FlightFile file;
  file.set("why", "asked for");
  file.take(**record, **shared);
  auto task = (*segment)->find<task::TaskShared>(task::kTaskBlock, task::kTaskAbi);
  task::MachineFacts facts;
  if (task.ok() && rtapi::read_patiently((*task)->facts, facts)) {
    file.set("ini", std::string(facts.ini_file.view()));
    if (const auto ini = ini::IniFile::load(std::string(facts.ini_file.view())); ini.ok)
      if (const ini::Entry* entry = ini.file.find("KINS", "KINEMATICS"); entry != nullptr)
        file.set("kinematics", entry->value);
    add_kinematics_values(**segment, file);
  }
  if (const auto written = write_whole(file, path); !written.ok()) {
    std::fprintf(stderr, "kerf: %s\n", written.error().message().c_str());
    return kExitFailure;
  }
  std::printf("%s\n", path.c_str());
  return kExitOk;
}

}  // namespace

std::string default_flight_folder() {
  return (fs::path(last_ini_file()).parent_path() / "flight-records").string();
}

FlightKeeper::FlightKeeper(rtapi::Segment& segment, Options options)
    : segment_(segment), options_(std::move(options)) {}

bool FlightKeeper::attach() {
  if (record_ != nullptr) return true;
  const hal::View view(segment_);
  auto shared = view.block<motion::MotionShared>(motion::kMotionBlock, motion::kMotionAbi);
  auto record = view.block<motion::FlightRecord>(motion::kFlightBlock, motion::kFlightAbi);
  if (!shared.ok() || !record.ok()) return false;
  motion_ = *shared;
  record_ = *record;
  return true;
}

std::string FlightKeeper::new_estop() {
  task::TaskStatus task;
  if (task_ == nullptr) {
    const auto shared = segment_.find<task::TaskShared>(task::kTaskBlock, task::kTaskAbi);
    if (!shared.ok() || !rtapi::read_patiently((*shared)->status, task)) return {};
    task_ = *shared;
    estops_seen_ = task.estops;
  }
  if (!rtapi::read_patiently(task_->status, task) || task.estops == estops_seen_) return {};
  estops_seen_ = task.estops;
  if (closing_) return {};
  return task.estop_external ? "external estop" : "estop, asked for by a client";
}

void FlightKeeper::look_for_estop() {
  const std::string estop = new_estop();
  // A fault that led to it says more.
  if (estop.empty() || looks_left_ > 0) return;
  why_ = "estop";
  text_ = estop;
  looks_left_ = kAftermathLooks;
}

void FlightKeeper::closing() {
  if (options_.keep > 0 && attach()) look_for_estop();
  closing_ = true;
}

std::string FlightKeeper::look() {
  if (options_.keep <= 0 || !attach()) return {};
  if (writing_.valid()) {
    if (writing_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return {};
    const auto path = writing_.get();
    return path.ok() ? *path : path.error().message();
  }
  const std::uint64_t newest = motion_->faults.newest.observe();
  for (; seen_ < newest; ++seen_) {
    motion::FaultRecord fault;
    if (!motion_->faults.slot[(seen_ + 1) % motion::FaultLog::kSlots].read(fault)) continue;
    if (looks_left_ > 0 || !motion::is_kept(fault.fault)) continue;
    why_ = motion::fault_name(fault.fault);
    motion::MachineConfig config;
    (void)rtapi::read_patiently(motion_->config, config);
    text_ = motion::fault_text(fault, config);
    looks_left_ = kAftermathLooks;
  }
  look_for_estop();
  if (looks_left_ == 0 || --looks_left_ > 0) return {};
  writing_ = begin(why_, text_);
  return {};
}

rtapi::Result<std::string> FlightKeeper::keep(const std::string& why, const std::string& text) {
  looks_left_ = 0;
  if (options_.keep <= 0 || !attach()) return fail(Errc::not_found, "there is no flight record");
  if (writing_.valid()) writing_.wait();  // its number is taken
  return begin(why, text).get();
}

std::future<rtapi::Result<std::string>> FlightKeeper::begin(const std::string& why,
                                                            const std::string& text) {
  std::error_code error;
  fs::create_directories(options_.folder, error);
  const auto old = records_in(options_.folder);
  const int number = old.empty() ? 1 : number_of(old.back()) + 1;
  char digits[16];
  std::snprintf(digits, sizeof digits, "%04d-", number);
  const std::string path = (fs::path(options_.folder) / (digits + why + kEnding)).string();
  motion::FlightFile file;
  file.set("why", why);
  file.set("text", text);
  describe(file);
  file.take(*record_, *motion_);
  return std::async(
      std::launch::async,
      [file = std::move(file), path, folder = options_.folder,
       keep = static_cast<std::size_t>(options_.keep)]() -> rtapi::Result<std::string> {
        KERF_CHECK(write_whole(file, path));
        remove_old(folder, keep);
        return path;
      });
}

void FlightKeeper::describe(motion::FlightFile& file) const {
  file.set("ini", options_.ini);
  file.set("kinematics", options_.kinematics);
  add_kinematics_values(segment_, file);
}

std::vector<std::string> FlightKeeper::choose_pins() {
  if (options_.pins.empty() || options_.keep <= 0 || !attach()) return {};
  const hal::View view(segment_);
  std::vector<std::string> missing, complaints;
  std::uint32_t count = record_->pin_count.get();
  for (const std::string& name : options_.pins) {
    hal::Type type = hal::Type::unspecified;
    hal::SlotRef slot;
    if (const auto signal = view.find_signal(name); signal && !signal->pins.empty()) {
      type = signal->type;
      slot = view.pin_slot(signal->pins.front().name);
    } else if (const auto item = view.find_item(name)) {
      type = item->type;
      slot = view.slot(name);
    }
    if (slot.link == nullptr || count >= motion::kMaxRecordedPins) {
      missing.push_back(name);
      const auto value = view.value(name);
      complaints.push_back(
          "[KERF]RECORD_PIN = " + name + ": " +
          (value.ok() ? "a signal without pins" : std::string(value.error().what.view())));
      continue;
    }
    motion::RecordedPin& pin = record_->pin[count];
    pin.name.assign(name);
    pin.type = static_cast<std::uint32_t>(type);
    pin.every_cycle = type == hal::Type::floating ? 0 : 1;
    pin.link = segment_.offset_of(slot.link);
    record_->pin_count.publish(++count);
  }
  options_.pins = missing;
  return complaints;
}

int record_command(const std::vector<std::string>& words, const std::string& bin) {
  if (words.size() >= 2 && (words[1] == "--help" || words[1] == "-h")) return usage(kExitOk);
  if (words[0] == "replay")
    return words.size() == 2 ? run_tool(bin, {words[1]}) : usage(kExitUsage);
  if (words.size() >= 3 && words[1] == "show" && words.size() <= 4) {
    std::vector<std::string> tool{"--show", words[2]};
    if (words.size() == 4) tool.push_back(words[3]);
    return run_tool(bin, tool);
  }
  if (words.size() < 3 || words[1] != "dump") return usage(kExitUsage);
  std::string instance = rtapi::default_instance();
  if (words.size() == 5 && words[3] == "--instance")
    instance = words[4];
  else if (words.size() != 3)
    return usage(kExitUsage);
  return dump(instance, words[2]);
}

}  // namespace kerf::launcher
