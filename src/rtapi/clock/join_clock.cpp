#include "rtapi/clock/join_clock.hpp"

#include <dlfcn.h>

#include <vector>

#include "rtapi/clock/real_clock.hpp"
#include "rtapi/clock/virtual_clock.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::rtapi {

namespace {

class SegmentClock final : public Clock {
 public:
  explicit SegmentClock(const ClockBlock& block) : block_(block) {}
  [[nodiscard]] Nanos now() const noexcept override { return block_.now_ns.get(); }
  [[nodiscard]] bool is_virtual() const noexcept override { return true; }

 private:
  const ClockBlock& block_;
};

class RealThread final : public SharedThread {
 public:
  explicit RealThread(Participant& participant)
      : clock_(make_real_clock()), participant_(participant) {}
  void run() override { run_participant(*clock_, participant_); }
  void stop() noexcept override { clock_->stop(); }

 private:
  std::unique_ptr<WaitClock> clock_;
  Participant& participant_;
};

class VirtualThread final : public SharedThread {
 public:
  Status add(Segment& segment, ClockBlock& block, Participant& participant) {
    KERF_TRY(auto clock,
             VirtualClock::take_place(segment, block, participant.role(), participant.name()));
    places_.push_back(clock.get());
    clocks_.push_back(std::move(clock));
    participants_.push_back(&participant);
    return {};
  }
  void run() override { VirtualClock::run(places_, participants_); }
  void stop() noexcept override {
    for (VirtualClock* place : places_) place->stop();
  }

 private:
  std::vector<std::unique_ptr<VirtualClock>> clocks_;
  std::vector<VirtualClock*> places_;
  std::vector<Participant*> participants_;
};

ClockBlock* find_virtual(const Segment& segment) {
  auto found = segment.find<ClockBlock>(ClockBlock::kName);
  return found.ok() && (*found)->mode == ClockMode::virtual_time ? *found : nullptr;
}

}  // namespace

Status make_clock(Segment& segment, ClockMode mode, double speed) {
  KERF_TRY(ClockBlock * block, segment.make<ClockBlock>(ClockBlock::kName));
  block->mode = mode;
  block->speed = speed;
  block->paced_real_ns = monotonic_now();
  pthread_mutexattr_t attributes;
  pthread_mutexattr_init(&attributes);
  pthread_mutexattr_setpshared(&attributes, PTHREAD_PROCESS_SHARED);
  pthread_mutexattr_setrobust(&attributes, PTHREAD_MUTEX_ROBUST);
  pthread_mutex_init(&block->mutex, &attributes);
  pthread_mutexattr_destroy(&attributes);
  return {};
}

ClockMode clock_mode(const Segment& segment) {
  return find_virtual(segment) != nullptr ? ClockMode::virtual_time : ClockMode::real;
}

Result<std::unique_ptr<WaitClock>> join_clock(Segment& segment, Role role, std::string_view name,
                                              bool foreign) {
  ClockBlock* block = find_virtual(segment);
  if (block == nullptr) return make_real_clock();
  auto joined = VirtualClock::join(segment, *block, role, name, foreign);
  if (!joined.ok()) return Failure{joined.error()};
  return std::unique_ptr<WaitClock>(std::move(*joined));
}

Result<std::unique_ptr<SharedThread>> SharedThread::join(
    Segment& segment, std::span<Participant* const> participants) {
  ClockBlock* block = find_virtual(segment);
  if (block == nullptr && participants.size() == 1)
    return std::unique_ptr<SharedThread>(std::make_unique<RealThread>(*participants.front()));
  if (block == nullptr) return fail(Errc::bad_argument, "a thread is shared on virtual time only");
  auto thread = std::make_unique<VirtualThread>();
  for (Participant* participant : participants)
    KERF_CHECK(thread->add(segment, *block, *participant));
  return std::unique_ptr<SharedThread>(std::move(thread));
}

bool lives_in_virtual_time(const Segment& segment, std::int64_t process_group) {
  ClockBlock* block = find_virtual(segment);
  return block != nullptr && VirtualClock::has_group(*block, process_group);
}

const Cell* clock_joins(const Segment& segment) {
  const ClockBlock* block = find_virtual(segment);
  return block == nullptr ? nullptr : &block->joins;
}

std::unique_ptr<WaitClock> make_real_clock() { return std::make_unique<RealClock>(); }

WaitClock* shim_clock(bool join) {
  using Get = WaitClock*(bool);
  static auto* const get = reinterpret_cast<Get*>(dlsym(RTLD_DEFAULT, "kerf_time_shim_clock"));
  return get == nullptr ? nullptr : get(join);
}

std::unique_ptr<Clock> read_clock(Segment& segment) {
  ClockBlock* block = find_virtual(segment);
  if (block == nullptr) return std::make_unique<RealClock>();
  return std::make_unique<SegmentClock>(*block);
}

}  // namespace kerf::rtapi
