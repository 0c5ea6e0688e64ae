#pragma once

#include "support/test.hpp"

#include <Eigen/Core>

namespace frontlux::test {

/// The part of a path, 0 to 1, within 1 m of what it was at least 6 m before, by the definition: the ends of
/// all pieces of up to a decimetre against all.
inline double plain_revisited_part(const std::vector<Eigen::Vector3d>& path) {
  struct End {
    Eigen::Vector3d place;
    double along, length;
  };
  std::vector<End> ends = {{path.front(), 0.0, 0.0}};
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double length = (path[i] - path[i - 1]).norm();
    const int pieces = static_cast<int>(std::ceil(length / 0.1));
    for (int k = 1; k <= pieces; ++k)
      ends.push_back({path[i - 1] + static_cast<double>(k) / pieces * (path[i] - path[i - 1]),
                      ends.back().along + length / pieces, length / pieces});
  }
  double revisited = 0.0;
  for (const End& end : ends)
    if (std::ranges::any_of(ends, [&](const End& earlier) {
          return earlier.along <= end.along - 6.0 && (earlier.place - end.place).norm() <= 1.0;
        }))
      revisited += end.length;
  return ends.back().along > 0.0 ? revisited / ends.back().along : 0.0;
}

}  // namespace frontlux::test
