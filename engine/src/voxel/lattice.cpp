#include <frontlux/lattice.hpp>

#include <stdexcept>
#include <string>

namespace frontlux {

Lattice::Lattice(double resolution) : resolution_(resolution), factor_(1. / resolution) {
  if (!(std::isfinite(resolution) && resolution > 0. && std::isfinite(factor_)))
    throw std::invalid_argument("resolution must be a positive, finite length in metres, got " +
                                std::to_string(resolution));
}

}  // namespace frontlux
