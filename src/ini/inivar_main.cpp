#include <cstdio>

#include "ini/inivalue.hpp"

int main(int argc, char** argv) {
  const auto result = kerf::ini::run_inivar({argv + 1, argv + argc});
  std::fputs(result.err.c_str(), stderr);
  std::fputs(result.out.c_str(), stdout);
  return result.exit_code;
}
