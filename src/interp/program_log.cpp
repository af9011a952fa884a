#include "interp/program_log.hpp"

namespace kerf::interp {

ProgramLog::~ProgramLog() {
  if (file_ != nullptr && file_ != stderr) std::fclose(file_);
}

void ProgramLog::write(std::string_view line) {
  if (file_ == nullptr && !path_.empty()) {
    file_ = std::fopen(path_.c_str(), "ae");
    if (file_ == nullptr)
      std::fprintf(stderr, "[RS274NGC]LOG_FILE = %s cannot be written; the log goes here\n",
                   path_.c_str());
  }
  if (file_ == nullptr) file_ = stderr;
  std::fprintf(file_, "%.*s\n", static_cast<int>(line.size()), line.data());
  std::fflush(file_);
}

}  // namespace kerf::interp
