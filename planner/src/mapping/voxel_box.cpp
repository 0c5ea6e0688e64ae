#include <frontlux/planner/mapping.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

namespace frontlux::planner {

KeyBox voxels_of(const Lattice& lattice, const Eigen::AlignedBox3d& box) {
  constexpr double kOnFace = 1e-6;  // [voxels]
  std::array<std::uint16_t, 3> min{}, max{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double low = box.min()[static_cast<Eigen::Index>(i)] / lattice.resolution() + Lattice::kOrigin;
    const double high = box.max()[static_cast<Eigen::Index>(i)] / lattice.resolution() + Lattice::kOrigin;
    const double first = std::max(0.0, std::floor(low + kOnFace));
    const double last = std::min(Lattice::kKeysPerAxis - 1.0, std::ceil(high - kOnFace) - 1.0);
    if (!(low < high) || !(first <= last))
      throw std::invalid_argument("the box from " + std::to_string(box.min()[static_cast<Eigen::Index>(i)]) +
                                  " m to " + std::to_string(box.max()[static_cast<Eigen::Index>(i)]) +
                                  " m along " + "xyz"[i] + " holds no voxel of the map, which goes from " +
                                  std::to_string(-Lattice::kOrigin * lattice.resolution()) + " m to " +
                                  std::to_string(Lattice::kOrigin * lattice.resolution()) + " m");
    min[i] = static_cast<std::uint16_t>(first);
    max[i] = static_cast<std::uint16_t>(last);
  }
  return {{min[0], min[1], min[2]}, {max[0], max[1], max[2]}};
}

}  // namespace frontlux::planner
