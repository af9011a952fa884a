// SampleReader: what halsampler does, without its process: prints the rows of a sampler's FIFO.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>

#include "hal/stream.hpp"
#include "rtapi/clock/clock.hpp"

namespace kerf::hal {

class SampleReader final : public rtapi::Participant {
 public:
  struct Options {
    bool tagged{false};      ///< first column: the sample's number
    std::int64_t count{-1};  ///< samples to print; below zero: without end
  };
  /// `out` must outlive the reader.
  SampleReader(Stream stream, Options options, std::FILE* out)
      : stream_(stream), options_(options), out_(out) {}

  [[nodiscard]] const char* name() const noexcept override { return "halsampler"; }
  [[nodiscard]] rtapi::Role role() const noexcept override { return rtapi::Role::user_component; }
  void step(rtapi::Nanos now, rtapi::WaitSpec& next) override;

  /// True when nothing is left to do: all was printed, or error() says why not.
  [[nodiscard]] bool done() const noexcept { return done_; }
  [[nodiscard]] const std::string& error() const noexcept { return error_; }

 private:
  void print(const StreamRow& row);
  void finish(std::string error = {});

  Stream stream_;
  Options options_;
  std::FILE* out_;
  std::int64_t printed_{0};
  bool done_{false};
  std::string error_;
};

}  // namespace kerf::hal
