#include <frontlux/planner/scan.hpp>

#include <cmath>
#include <stdexcept>
#include <string>

namespace frontlux::planner {

void check(const Scan& scan) {
  const auto refuse = [](const std::string& what) { throw std::invalid_argument("scan: " + what); };
  if (scan.directions.size() != scan.ranges.size())
    refuse(std::to_string(scan.directions.size()) + " directions, but " + std::to_string(scan.ranges.size()) +
           " ranges");
  if (!scan.origin.allFinite()) refuse("its origin is not finite");
  if (!(scan.max_range > 0.0 && std::isfinite(scan.max_range)))
    refuse("max_range is " + std::to_string(scan.max_range) + " m, but has to be positive");
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    if (!(std::fabs(scan.directions[i].norm() - 1.0F) < 1e-3F))
      refuse("direction " + std::to_string(i) + " is not of unit length");
    const auto range = static_cast<double>(scan.ranges[i]);
    if (range < 0.0 || (std::isfinite(range) && range > scan.max_range * (1.0 + 1e-6)))
      refuse("range " + std::to_string(i) + " is " + std::to_string(range) + " m, outside 0 to max_range, " +
             std::to_string(scan.max_range) + " m");
  }
}

}  // namespace frontlux::planner
