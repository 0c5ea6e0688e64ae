#pragma once

#include "world_source.hpp"

#include <string>
#include <vector>

namespace frontlux::app {

/// A run of `frontlux explore` as the user asks for it; everything that its result depends on.
struct ExploreOptions {
  WorldSource source;                    // its resolution is `resolution`, its seed `seed`
  std::string team = "uav+ugv";          ///< names with + between them, a number before a name for several
  std::vector<std::string> robot_files;  ///< more robots
  std::vector<std::string> poses;        ///< NAME=x,y,z,yaw of sensors that are not to start near the start
  std::string mode = "default", goal, search, renderer;  ///< the last three: by the mode if empty
  std::string distribute = "on", optimize = "on", caster = "fast";
  std::string seed = "1", max_steps = "1000", resolution = "0.3";
  std::string epsilon, lambda, advance, min_distance, samples;  ///< by mode and goal if empty
  std::string noise = "0", dropout = "0";
};

/// As a JSON object, on one line.
[[nodiscard]] std::string to_json(const ExploreOptions& options);

/// What `to_json` made. Members that are missing keep their default.
/// @throws std::runtime_error if it is not such an object
[[nodiscard]] ExploreOptions explore_options_of(const std::string& json);

}  // namespace frontlux::app
