// Largest eigenvalue of a symmetric tridiagonal matrix and the last component of its eigenvector,
// for the Lanczos method. Host.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace brickwall::mechanics {

struct RitzValue {
  double value = 0;
  double last = 1; // |component| of the unit eigenvector in the last row
};

// Diagonal alpha [n], off-diagonal beta [n - 1] or more, all > 0. By bisection (Sturm: the ratios
// of the leading minors of x - T are positive for x above all eigenvalues) and by the recurrence of
// the eigenvector from its end, where it is small.
inline RitzValue largestRitzValue(const std::vector<double>& alpha,
                                  const std::vector<double>& beta) {
  const std::size_t n = alpha.size();
  double low = alpha[0], high = alpha[0];
  for (std::size_t i = 0; i < n; ++i) {
    const double radius = (i > 0 ? beta[i - 1] : 0) + (i + 1 < n ? beta[i] : 0);
    low = std::fmax(low, alpha[i]);
    high = std::fmax(high, alpha[i] + radius);
  }
  const auto isAbove = [&](double x) {
    double ratio = x - alpha[0];
    for (std::size_t i = 1; i < n && ratio > 0; ++i)
      ratio = x - alpha[i] - beta[i - 1] * beta[i - 1] / ratio;
    return ratio > 0;
  };
  for (int i = 0; i < 100 && low < high; ++i) {
    const double middle = low + 0.5 * (high - low);
    if (middle <= low || middle >= high)
      break;
    (isAbove(middle) ? high : low) = middle;
  }
  RitzValue result{high, 1};
  double next = 0, here = 1, square = 1; // components i + 1, i
  for (std::size_t i = n - 1; i > 0; --i) {
    const double before =
        ((high - alpha[i]) * here - (i + 1 < n ? beta[i] * next : 0)) / beta[i - 1];
    next = here;
    here = before;
    square += here * here;
  }
  result.last = 1 / std::sqrt(square);
  return result;
}

} // namespace brickwall::mechanics
