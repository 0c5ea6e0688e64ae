#include "explore/run_forecast.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace frontlux::app {

std::optional<double> RunForecast::left() const {
  constexpr double kLeast = 1.0;     // [s] that it looks back
  constexpr double kLastPart = 0.4;  // of the time so far
  if (noted_.empty()) return std::nullopt;
  const auto& [seconds, now] = noted_.back();
  const auto before = std::ranges::lower_bound(noted_, (1.0 - kLastPart) * seconds, {}, &Noted::seconds);
  const double time = seconds - before->seconds;
  std::optional<double> left;
  if (time < kLeast) return left;
  for (std::size_t i = 0; i < now.size(); ++i) {
    const double grown = now[i] - before->quantities[i];
    if (!(grown > 0.0) || !std::isfinite(ends_[i])) continue;
    const double until = std::max(0.0, ends_[i] - now[i]) / grown * time;
    left = std::min(left.value_or(until), until);
  }
  return left;
}

std::string about(double seconds) {
  constexpr double kTens = 10.0, kMinute = 60.0, kMinutes = 100.0;
  if (seconds < kMinutes)
    return "about " + std::to_string(static_cast<int>(std::max(1.0, std::ceil(seconds / kTens)) * kTens)) +
           " s";
  return "about " + std::to_string(static_cast<long>(std::ceil(seconds / kMinute))) + " min";
}

}  // namespace frontlux::app
