/// A test program that does not end says in which test it hangs, and where, before CTest kills it without a word.
///
/// Linked into every kerf_test(). CTest gives the program its time in KERF_TEST_TIMEOUT_S; started by hand there is none,
/// and no watch. The watch is a timer of the kernel, so that it also acts in a test whose threads all wait.
#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>
#include <string_view>

#include <execinfo.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace {

/// How long before CTest's end the watch speaks.
constexpr int kAheadS = 5;

/// The test that runs, for the signal handler: nothing there may allocate. Half a name is no harm.
char running[256] = "no test";

void say(std::string_view text) { (void)!::write(STDERR_FILENO, text.data(), text.size()); }

/// The program's first byte, given by the linker.
extern "C" const char
    __ehdr_start;  // NOLINT(bugprone-reserved-identifier,readability-identifier-naming)

/// Lets binutils' addr2line print the functions and lines of `frames`: the symbols are in the program's debug information.
void print_lines(void** frames, int count) {
  static char program[512];
  static char places[64][20];
  const char* words[70] = {"addr2line", "-Cfspie", program};
  const ssize_t length = ::readlink("/proc/self/exe", program, sizeof program - 1);
  program[std::max<ssize_t>(length, 0)] = 0;
  for (int i = 0; i < count; ++i) {
    auto offset = reinterpret_cast<std::uintptr_t>(frames[i]) -
                  reinterpret_cast<std::uintptr_t>(&__ehdr_start);
    char* digit = places[i] + sizeof places[i] - 1;
    do {
      *--digit = "0123456789abcdef"[offset % 16];
      offset /= 16;
    } while (offset != 0);
    words[3 + i] = digit;
  }
  if (::fork() == 0) {
    ::dup2(STDERR_FILENO, STDOUT_FILENO);
    ::execvp(words[0], const_cast<char* const*>(words));
    ::_exit(1);
  }
  ::wait(nullptr);
}

void give_up(int /*signal*/) {
  say("\nhangs: ");
  say(running);
  say("\nthe main thread is at\n");
  void* frames[64];
  const int count = ::backtrace(frames, 64);
  ::backtrace_symbols_fd(frames, count, STDERR_FILENO);
  print_lines(frames, count);
  std::signal(SIGABRT, SIG_DFL);
  std::abort();
}

class Names : public testing::EmptyTestEventListener {
  void OnTestStart(const testing::TestInfo& test) override {
    const std::string name = std::string(test.test_suite_name()) + "." + test.name();
    std::strncpy(running, name.c_str(), sizeof running - 1);
  }
};

/// Before main(): the program's own main is GoogleTest's.
const bool watching = [] {
  const char* limit = std::getenv("KERF_TEST_TIMEOUT_S");
  const int limit_s = limit == nullptr ? 0 : std::atoi(limit);
  if (limit_s <= kAheadS) return false;
  testing::UnitTest::GetInstance()->listeners().Append(new Names);
  void* first[1];
  (void)::backtrace(first, 1);  // loads what it needs now: a handler must not
  // A signal that no test and nothing under test uses; not inherited by children.
  const int signal = SIGRTMAX - 3;
  std::signal(signal, give_up);
  sigevent event{};
  event.sigev_notify = SIGEV_THREAD_ID;
  event.sigev_signo = signal;
  event._sigev_un._tid = ::gettid();
  timer_t timer{};
  if (::timer_create(CLOCK_MONOTONIC, &event, &timer) != 0) return false;
  itimerspec time{};
  time.it_value.tv_sec = limit_s - kAheadS;
  return ::timer_settime(timer, 0, &time, nullptr) == 0;
}();

}  // namespace
