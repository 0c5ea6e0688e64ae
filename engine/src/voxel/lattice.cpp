#include <frontlux/file.hpp>
#include <frontlux/floating_point_mode.hpp>
#include <frontlux/lattice.hpp>

#include <stdexcept>

namespace frontlux {
namespace {

// As OctoMap's, in whatever mode a thread makes a map: rounded otherwise, points on faces get other keys.
double inverse_of(double resolution) {
  const FloatingPointMode mode(FloatingPointMode::kToNearest);
  // Volatile, since compilers know nothing of modes, and might divide before this one is set.
  const volatile double given = resolution, inverse = 1. / given;
  return inverse;
}

}  // namespace

Lattice::Lattice(double resolution) : resolution_(resolution), voxels_per_metre_(inverse_of(resolution)) {
  if (!(std::isfinite(resolution) && resolution > 0. && std::isfinite(voxels_per_metre_)))
    throw std::invalid_argument("resolution must be a positive, finite length in metres, got " +
                                decimals_of(resolution));
}

}  // namespace frontlux
