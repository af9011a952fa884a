// SampleReader: what halsampler does: prints the rows of a sampler's FIFO.
#pragma once

#include <cstdint>
#include <cstdio>

#include "hal/stream.hpp"
#include "hal/tools/stream_program.hpp"

namespace kerf::hal {

class SampleReader final : public StreamTask {
 public:
  struct Options {
    bool tagged{false};      ///< first column: the sample's number
    std::int64_t count{-1};  ///< samples to print; below zero: without end
  };
  /// `out` must outlive the reader.
  SampleReader(Stream stream, Options options, std::FILE* out)
      : stream_(stream), options_(options), out_(out) {}

  [[nodiscard]] const char* name() const noexcept override { return "halsampler"; }
  void step(rtapi::Nanos now, rtapi::WaitSpec& next) override;

 private:
  void print(const StreamRow& row);

  Stream stream_;
  Options options_;
  std::FILE* out_;
  std::int64_t printed_{0};
};

}  // namespace kerf::hal
