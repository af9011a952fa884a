// LiveBuilder: exports what a component declares into the running HAL. Private to Host.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "hal/component.hpp"
#include "hal/loader/host.hpp"

namespace kerf::hal {

/// One for all instances of a loadrt. Threads and participants are only collected: Host starts them when all went well.
class LiveBuilder final : public Builder {
 public:
  struct ThreadWish {
    std::string name;
    std::int64_t period_ns;
  };

  LiveBuilder(Host& host, Host::Loaded& loaded,
              std::map<std::string, std::string, std::less<>> args)
      : host_(host), loaded_(loaded), args_(std::move(args)) {
    declares_only_ = host.driver_ != nullptr && host.driver_->declares_only();
  }

  void begin_instance(std::string_view prefix, std::int64_t personality) {
    prefix_ = Name(prefix);
    personality_ = personality;
  }
  [[nodiscard]] const std::string& error() const { return error_; }
  [[nodiscard]] const std::vector<ThreadWish>& threads() const { return threads_; }
  /// Empty, or the complaint about a parameter that no instance asked for.
  [[nodiscard]] std::string unknown_arg() const;

  void add_pin(std::string_view name, Type type, Dir dir, std::uint64_t initial,
               std::string_view doc, PinCell* cell) noexcept override;
  FixedSlot add_param(std::string_view name, Type type, Dir dir, std::uint64_t initial,
                      std::string_view doc) noexcept override;
  void add_function(std::string_view name, FunctionThunk thunk, void* object,
                    std::string_view doc) noexcept override;
  std::string_view arg(std::string_view name, std::string_view default_text,
                       std::string_view doc) noexcept override;
  void* allocate(std::size_t bytes, std::size_t align) noexcept override;
  std::byte* shared_block(std::string_view name, std::size_t bytes,
                          std::uint64_t abi) noexcept override;
  void provide(std::string_view service, void* object) noexcept override;
  void* find_service(std::string_view service) noexcept override;
  void* find_c_function(std::string_view name) noexcept override;
  void call_c(void (*code)(void*), void* argument) noexcept override;
  void add_participant(rtapi::Participant& participant) noexcept override;
  void add_thread(std::string_view name, std::int64_t period_ns) noexcept override;
  [[nodiscard]] const rtapi::Clock& clock() const noexcept override { return host_.clock(); }
  void fail(std::string_view what) noexcept override;
  [[nodiscard]] bool failed() const noexcept override { return !error_.empty(); }
  /// Makes NAME.time, .tmax and .tmax-increased of the functions added so far. After all instances: what the functions work on then
  /// stands together, and what is seldom touched apart.
  void show_times() noexcept;

 private:
  void make_times(FunctionRecord& record) noexcept;

  Host& host_;
  Host::Loaded& loaded_;
  std::map<std::string, std::string, std::less<>> args_;
  std::set<std::string, std::less<>> asked_;
  std::vector<ThreadWish> threads_;
  std::string error_;
  std::vector<FunctionRecord*> without_times_;
  Host::Loaded* c_module_{nullptr};  ///< of the function found last
  std::uint64_t dummy_{0};           ///< the slot that handles lead to after an error
};

}  // namespace kerf::hal
