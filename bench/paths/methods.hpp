#pragma once

#include <frontlux/planner/path_optimizer.hpp>

#include <optional>
#include <string_view>
#include <vector>

namespace frontlux::bench {

/// A way to choose the yaws of a path.
struct YawMethod {
  std::string_view name;
  std::optional<planner::PathOptimizerOptions> options;  ///< none: yaws along the path
};

/// From the plain tangent to the default.
[[nodiscard]] std::vector<YawMethod> yaw_methods();

}  // namespace frontlux::bench
