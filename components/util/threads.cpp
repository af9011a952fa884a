// threads: makes up to three realtime threads.
#include "hal/component.hpp"

namespace kerf::components {

namespace {
/// The names of one thread's loadrt parameters and what they are when not given.
struct ThreadArgs {
  std::string_view name_key, name_default;
  std::string_view period_key;
  std::int64_t period_default;
  std::string_view fp_key;
};
constexpr ThreadArgs kThreads[] = {
    {"name1", "thread1", "period1", 1'000'000, "fp1"},
    {"name2", "", "period2", 0, "fp2"},
    {"name3", "", "period3", 0, "fp3"},
};
constexpr std::string_view kNameDoc = "Name of the thread";
constexpr std::string_view kPeriodDoc = "Period [ns]";
constexpr std::string_view kFpDoc = "Accepted and not used: every thread may compute with floats";
}  // namespace

class Threads final : public hal::Component<Threads> {
 public:
  static constexpr hal::Info kInfo{
      .name = "threads",
      .summary = "Makes realtime threads",
      .notes =
          "One to three threads, the fastest first: name1= period1= to name3= period3=. Periods "
          "are "
          "in nanoseconds. Without any parameter there is one thread, thread1, of 1 ms. The "
          "component has no pins and no functions; the threads stay when it is unloaded, and it "
          "can "
          "be loaded again to make more of them.",
      .singleton = true};

  explicit Threads(hal::Builder& b) noexcept : Component(b) { make_threads(b); }

 private:
  static constexpr std::string_view kOrder = " is shorter than the one before it, thread ";

  void make_threads(hal::Builder& b) noexcept {
    std::int64_t faster_ns = 0;
    for (const ThreadArgs& args : kThreads) {
      const std::string_view name = text_arg(args.name_key, args.name_default, kNameDoc);
      const std::int64_t period_ns = int_arg(args.period_key, args.period_default, kPeriodDoc);
      (void)int_arg(args.fp_key, 1, kFpDoc);
      if (b.failed()) return;
      if (name.empty() && period_ns == 0) continue;
      if (name.empty()) return complain(args.name_key, " is missing for ", args.period_key);
      if (period_ns <= 0) return complain(args.period_key, " must be above zero, thread ", name);
      if (period_ns < faster_ns) return complain(args.period_key, kOrder, name);
      b.add_thread(name, period_ns);
      faster_ns = period_ns;
    }
  }

  void complain(std::string_view key, std::string_view what, std::string_view name) noexcept {
    rtapi::FixedString<160> text;
    text.append(key);
    text.append(what);
    text.append(name);
    builder().fail(text);
  }
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Threads)
