// Rig: an interpreter with a printing canon and a scripted world, for tests.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "interp/interpreter.hpp"
#include "interp/parameters.hpp"
#include "interp/rs274/bench_environment.hpp"
#include "interp/text_canon.hpp"

namespace kerf::interp {

/// HAL pins, INI keys and user M-codes from maps; tools and subs from BenchEnvironment.
class ScriptedWorld final : public Environment {
 public:
  BenchEnvironment files;
  std::map<std::string, double> hal, ini;  // ini: "SECTION/KEY"
  std::map<int, UserMcode> mcodes;
  std::vector<std::string> warnings;

  std::optional<Tool> find_tool(int number) override { return files.find_tool(number); }
  std::optional<Tool> find_pocket(int pocket) override { return files.find_pocket(pocket); }
  std::string find_sub(std::string_view name) override { return files.find_sub(name); }
  UserMcode find_user_mcode(int number) override { return mcodes[number]; }
  void warning(std::string_view text) override { warnings.emplace_back(text); }
  std::optional<double> hal_value(std::string_view name) override {
    return look(hal, std::string(name));
  }
  std::optional<double> ini_value(std::string_view section, std::string_view key) override {
    return look(ini, std::string(section) + "/" + std::string(key));
  }

 private:
  static std::optional<double> look(const std::map<std::string, double>& m,
                                    const std::string& key) {
    const auto hit = m.find(key);
    return hit == m.end() ? std::nullopt : std::optional<double>(hit->second);
  }
};

/// A canon that prints into memory.
class PrintedCalls {
 public:
  PrintedCalls() : out_(open_memstream(&text_, &size_)), canon_(out_) {}
  ~PrintedCalls() {
    std::fclose(out_);
    std::free(text_);
  }
  PrintedCalls(const PrintedCalls&) = delete;
  PrintedCalls& operator=(const PrintedCalls&) = delete;

  [[nodiscard]] TextCanon& canon() noexcept { return canon_; }
  /// The calls printed since the last take(), one a line, without counter and "N..... ".
  std::string take() {
    std::fflush(out_);
    std::string all(text_ + taken_, size_ - taken_);
    taken_ = size_;
    std::string clean;
    for (std::size_t at = 0; at < all.size();) {
      const std::size_t end = all.find('\n', at);
      std::string_view line(all.data() + at, end - at);
      const std::size_t n = line.find(" N");
      if (n != std::string_view::npos && n < 12) line.remove_prefix(n + 8);
      clean.append(line).push_back('\n');
      at = end + 1;
    }
    return clean;
  }

 private:
  char* text_{nullptr};
  std::size_t size_{0}, taken_{0};
  std::FILE* out_;
  TextCanon canon_;
};

class Rig {
 public:
  explicit Rig(const Settings& settings = {}) : interp(world, printed_.canon(), settings) {
    interp.init();
    (void)calls();
  }

  /// The calls printed since the last calls().
  std::string calls() { return printed_.take(); }
  /// Runs one MDI line to its end; answers every wait with `answer`. The printed calls, or "error: TEXT".
  std::string mdi(std::string_view line, const ExternalState& answer = {}) {
    Outcome o = interp.execute_mdi(line);
    while (o == Outcome::ok || o == Outcome::needs_sync) {
      if (o == Outcome::needs_sync) interp.synchronize(answer);
      if (!interp.mdi_active()) break;
      o = interp.execute_next();
    }
    std::string c = calls();
    if (o != Outcome::error) return c;
    if (interp.mdi_active()) interp.abort();
    return c + "error: " + interp.error().text;
  }
  /// Runs a whole program; the printed calls, and "error: TEXT" at the end when it fails.
  std::string run(const std::string& program) {
    EXPECT_TRUE(interp.open_text("test.ngc", program).ok());
    for (int i = 0; i < 100000; ++i) {
      const Outcome o = interp.execute_next();
      if (o == Outcome::needs_sync) interp.synchronize({});
      if (o == Outcome::error) return calls() + "error: " + interp.error().text;
      if (o == Outcome::program_end || o == Outcome::idle) return calls();
    }
    return calls() + "error: no end";
  }
  /// What (debug, TEXT) prints.
  std::string debug(const std::string& text) {
    const std::string c = mdi("(debug," + text + ")");
    const std::size_t a = c.find('"'), b = c.rfind('"');
    return a == std::string::npos ? c : c.substr(a + 1, b - a - 1);
  }

 private:
  PrintedCalls printed_;

 public:
  ScriptedWorld world;
  Interpreter interp;
};

}  // namespace kerf::interp
