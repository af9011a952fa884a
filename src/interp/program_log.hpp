// ProgramLog: what [RS274NGC]LOG_LEVEL asks for, a line each, in LOG_FILE or on standard error.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

#include "interp/environment.hpp"

namespace kerf::interp {

class ProgramLog {
 public:
  /// Opens nothing until the first line; a file is appended to.
  explicit ProgramLog(const Settings& settings) : path_(settings.log_file) {}
  ~ProgramLog();
  ProgramLog(const ProgramLog&) = delete;
  ProgramLog& operator=(const ProgramLog&) = delete;

  void write(std::string_view line);

 private:
  std::string path_;
  std::FILE* file_{nullptr};
};

}  // namespace kerf::interp
