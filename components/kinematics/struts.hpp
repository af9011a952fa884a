// Forward kinematics of machines that hold the tool by struts: the pose whose struts have the given lengths, by Newton's method
// from where the tool was. The inverse of such machines is plain, so the Jacobian comes from it by differences.
#pragma once

#include <array>

#include "kinematics_module.hpp"

namespace kerf::kinematics {

/// When the search ends.
struct StrutSearch {
  double good_mm{1e-9};    ///< sum of the struts' errors that is a solution
  double bad_mm{500};      ///< one that is none
  std::int32_t most{120};  ///< steps
};

/// Gaussian elimination with pivots. False: singular.
template <std::size_t N>
bool solve(double (&m)[N][N + 1], std::array<double, N>& out) noexcept {
  for (std::size_t c = 0; c < N; ++c) {
    std::size_t best = c;
    for (std::size_t r = c + 1; r < N; ++r)
      if (std::fabs(m[r][c]) > std::fabs(m[best][c])) best = r;
    if (!(std::fabs(m[best][c]) > 1e-10)) return false;
    for (std::size_t k = 0; k <= N; ++k) {
      const double keep = m[c][k];
      m[c][k] = m[best][k];
      m[best][k] = keep;
    }
    for (std::size_t r = c + 1; r < N; ++r) {
      const double factor = m[r][c] / m[c][c];
      for (std::size_t k = c; k <= N; ++k) m[r][k] -= factor * m[c][k];
    }
  }
  for (std::size_t c = N; c-- > 0;) {
    double sum = m[c][N];
    for (std::size_t k = c + 1; k < N; ++k) sum -= m[c][k] * out[k];
    out[c] = sum / m[c][c];
  }
  return true;
}

/// `length(pose, lengths)` gives the N struts' lengths; pose holds X Y Z and N - 3 angles. False: no solution from this start.
template <std::size_t N, class Lengths>
bool find_pose(const Lengths& length, const std::array<double, N>& wanted,
               std::array<double, N>& pose, const StrutSearch& search,
               std::int32_t& steps) noexcept {
  using Row = std::array<double, N>;
  const auto errors = [&](const Row& at, Row& error) {
    Row now{};
    length(at, now);
    double sum = 0;
    for (std::size_t i = 0; i < N; ++i) {
      error[i] = wanted[i] - now[i];
      sum += std::fabs(error[i]);
    }
    return sum;
  };
  Row at = pose, error{};
  double sum = errors(at, error);
  bool found = false;
  for (; steps < search.most; ++steps) {
    if (!(sum <= search.bad_mm)) return false;  // also when it is no number
    // One step more than is needed: it takes the rest of the error to the last digits.
    const bool last = sum <= search.good_mm;
    double matrix[N][N + 1];
    for (std::size_t k = 0; k < N; ++k) {
      const double h = k < 3 ? 1e-3 : 1e-2;  // mm, degrees
      Row high = at, low = at, up{}, down{};
      high[k] += h;
      low[k] -= h;
      length(high, up);
      length(low, down);
      for (std::size_t i = 0; i < N; ++i) matrix[i][k] = (up[i] - down[i]) / (2 * h);
    }
    for (std::size_t i = 0; i < N; ++i) matrix[i][N] = error[i];
    Row step{};
    if (!solve<N>(matrix, step)) break;
    double part = 1;
    for (std::size_t k = 0; k < N; ++k) {
      constexpr double kLongest = 50, kWidest = 4;  // mm, degrees in a step
      const double limit = k < 3 ? kLongest : kWidest;
      if (std::fabs(step[k]) * part > limit) part = limit / std::fabs(step[k]);
    }
    Row next = at, next_error{};
    for (std::size_t k = 0; k < N; ++k) next[k] += step[k] * part;
    const double next_sum = errors(next, next_error);
    if (last) {
      if (next_sum < sum) at = next;
      found = true;
      break;
    }
    at = next;
    error = next_error;
    sum = next_sum;
  }
  if (found || sum <= search.good_mm) pose = at;
  return found || sum <= search.good_mm;
}

}  // namespace kerf::kinematics
