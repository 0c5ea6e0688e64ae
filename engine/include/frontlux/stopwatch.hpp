#pragma once

#include <chrono>
#include <utility>

namespace frontlux {

/// Measures time from when it was made, or from its last lap.
class Stopwatch {
 public:
  /// Time since it was made, or since its last lap [s].
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  /// The same [ms].
  [[nodiscard]] double milliseconds() const { return 1e3 * seconds(); }
  /// The seconds up to now, from where the next lap begins.
  double lap() {
    const auto begin = std::exchange(start_, std::chrono::steady_clock::now());
    return std::chrono::duration<double>(start_ - begin).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace frontlux
