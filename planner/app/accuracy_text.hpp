#pragma once

#include "text.hpp"

#include <frontlux/sim/accuracy.hpp>

#include <string>

namespace frontlux::app {

/// How right a map is by the true world, in words.
[[nodiscard]] inline std::string accuracy_text(const sim::Accuracy& accuracy) {
  return percent(accuracy.surface_part()) + " of the surface voxels occupied, " +
         percent(accuracy.false_free_part()) + " of the free ones hold a surface, " +
         percent(accuracy.false_occupied_part()) + " of the occupied ones are in free space";
}

}  // namespace frontlux::app
