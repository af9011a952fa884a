#include "task/screw_file.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <locale>
#include <sstream>

namespace kerf::task {
namespace {

/// "" or why this line is none. `had`: it holds a point.
std::string read_line(std::string text, double (&numbers)[3], bool& had) {
  text.resize(std::min(text.find_first_of("#;"), text.size()));
  std::istringstream words(text);
  std::string word;
  std::size_t n = 0;
  for (; words >> word; ++n) {
    if (n == 3) return "expected three numbers, found more";
    std::istringstream number(word);
    number.imbue(std::locale::classic());
    if (!(number >> numbers[n]) || !number.eof() || !std::isfinite(numbers[n]))
      return "'" + word + "' is no number";
  }
  had = n > 0;
  if (n != 0 && n != 3) return "expected three numbers: position, value going up, value going down";
  return {};
}

}  // namespace

std::string read_screw_file(const std::string& path, ScrewFileType type, double unit,
                            motion::ScrewTable& table) {
  table = {};
  std::ifstream in(path);
  if (!in) return "cannot open " + path;
  motion::ScrewTable read;
  std::string text;
  for (int line = 1; std::getline(in, text); ++line) {
    const auto wrong = [&](const std::string& what) {
      std::string out = path;
      return out.append(":").append(std::to_string(line)).append(": ").append(what);
    };
    double v[3]{};
    bool had = false;
    const std::string why = read_line(text, v, had);
    if (!why.empty()) return wrong(why);
    if (!had) continue;
    if (read.count == motion::ScrewTable::kMost)
      return wrong("more than " + std::to_string(motion::ScrewTable::kMost) + " points");
    motion::ScrewPoint& p = read.point[read.count];
    p.at = v[0] * unit;
    p.up = (type == ScrewFileType::positions ? v[0] - v[1] : v[1]) * unit;
    p.down = (type == ScrewFileType::positions ? v[0] - v[2] : v[2]) * unit;
    if (read.count > 0 && !(p.at > read.point[read.count - 1].at))
      return wrong("positions must ascend from line to line");
    ++read.count;
  }
  if (in.bad()) return "cannot read " + path;
  if (read.count == 0) return path + ": no points in it";
  table = read;
  return {};
}

}  // namespace kerf::task
