#include "draw/counts_seconds.hpp"

#include <nlohmann/json.hpp>

namespace frontlux::app {

bool counts_seconds(const planner::Recording& recording) {
  const auto options = nlohmann::json::parse(recording.head.options, nullptr, false);
  const auto lockstep = options.find("lockstep");
  const bool motion = lockstep != options.end() && *lockstep == false;
  return motion && recording.steps.back().step.time > 0.0;
}

}  // namespace frontlux::app
