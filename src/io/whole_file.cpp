// Files that outlive the power are written whole or not at all.
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>

#include "io/tool_table.hpp"

namespace kerf::io {
namespace {

using rtapi::Errc;
using rtapi::fail;

struct File {
  int fd{-1};
  ~File() {
    if (fd >= 0) ::close(fd);
  }
};

rtapi::Failure<rtapi::Error> errno_failure(const char* what, const std::string& file) {
  const int e = errno;
  return fail(e == ENOENT   ? Errc::not_found
              : e == EACCES ? Errc::permission
                            : Errc::system,
              std::string(what) + " " + file + ": " + std::strerror(e));
}

bool write_all(int fd, std::string_view text) {
  while (!text.empty()) {
    const ssize_t n = ::write(fd, text.data(), text.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

}  // namespace

rtapi::Result<std::string> read_file(const std::string& file) {
  File in{::open(file.c_str(), O_RDONLY | O_CLOEXEC)};
  if (in.fd < 0) return errno_failure("cannot open", file);
  std::string out;
  char buffer[16384];
  for (;;) {
    const ssize_t n = ::read(in.fd, buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return errno_failure("cannot read", file);
    if (n == 0) return out;
    out.append(buffer, static_cast<std::size_t>(n));
  }
}

rtapi::Status write_file_whole(const std::string& file, std::string_view text) {
  // The name is resolved first, so that a link is followed and not replaced.
  std::string target = file;
  if (const std::unique_ptr<char, decltype(&::free)> real(::realpath(file.c_str(), nullptr),
                                                          &::free);
      real != nullptr)
    target = real.get();
  std::string temp = target + ".XXXXXX";
  struct stat old {};
  const bool existed = ::stat(target.c_str(), &old) == 0;
  {
    File out{::mkostemp(temp.data(), O_CLOEXEC)};
    if (out.fd < 0) return errno_failure("cannot write beside", target);
    const mode_t mode = existed ? old.st_mode & 07777U : 0644U;
    if (!write_all(out.fd, text) || ::fchmod(out.fd, mode) != 0 || ::fsync(out.fd) != 0) {
      auto failure = errno_failure("cannot write", temp);
      ::unlink(temp.c_str());
      return failure;
    }
  }
  if (::rename(temp.c_str(), target.c_str()) != 0) {
    auto failure = errno_failure("cannot replace", target);
    ::unlink(temp.c_str());
    return failure;
  }
  const auto slash = target.rfind('/');
  File folder{::open(slash == std::string::npos ? "." : target.substr(0, slash + 1).c_str(),
                     O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  if (folder.fd >= 0)
    (void)::fsync(folder.fd);  // some file systems refuse it on folders; the file itself is synced
  return {};
}

}  // namespace kerf::io
