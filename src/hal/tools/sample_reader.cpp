#include "hal/tools/sample_reader.hpp"

#include <cerrno>
#include <cinttypes>
#include <cstring>

namespace kerf::hal {

void SampleReader::step(rtapi::Nanos now, rtapi::WaitSpec& next) {
  next.watch(stream_.changed());
  // Read before the rows: what a sampler wrote before it was unloaded is still printed.
  const bool closed = stream_.closed();
  StreamRow row;
  // One FIFO full at most, so that a fast sampler does not keep us from seeing a stop.
  for (std::uint32_t n = 0; n < stream_.depth() && stream_.front(row); ++n) {
    print(row);
    stream_.pop();
    if (++printed_ == options_.count) break;
  }
  const bool enough = printed_ == options_.count;
  const bool more = !enough && stream_.front(row);
  if (!more && (std::fflush(out_) != 0 || std::ferror(out_) != 0)) {
    finish(std::string("cannot write: ") + std::strerror(errno));
  } else if (enough) {
    finish();
  } else if (closed && !more) {
    finish("the sampler was unloaded");
  } else if (more) {
    next.until = now;
  }
}

void SampleReader::print(const StreamRow& row) {
  if (row.lost_before > 0) std::fputs("overrun\n", out_);
  // Rows of a stream are numbered from 1, samples from 0.
  if (options_.tagged)
    std::fprintf(out_, "%" PRId64 " ", static_cast<std::int64_t>(row.number) - 1);
  for (std::size_t i = 0; i < stream_.columns(); ++i) {
    const std::uint64_t raw = row.values[i];
    switch (stream_.type(i)) {
      case Type::bit: std::fputs(from_raw<bool>(raw) ? "1 " : "0 ", out_); break;
      case Type::floating: std::fprintf(out_, "%f ", from_raw<double>(raw)); break;
      case Type::u32:
      case Type::u64: std::fprintf(out_, "%" PRIu64 " ", from_raw<std::uint64_t>(raw)); break;
      default: std::fprintf(out_, "%" PRId64 " ", from_raw<std::int64_t>(raw)); break;
    }
  }
  std::fputc('\n', out_);
}

}  // namespace kerf::hal
