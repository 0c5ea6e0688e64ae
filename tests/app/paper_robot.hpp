#pragma once

#include "support/folder_test.hpp"

#include <nlohmann/json.hpp>

#include <string>

namespace frontlux::test {

/// One of the robots in data/robots without what it has in motion only, as `--robot ugv` and `uav` are.
inline std::string paper_robot(const std::string& name) {
  auto robot = nlohmann::json::parse(content_of(FRONTLUX_DATA_DIR "/robots/" + name + ".json"));
  robot.erase("margin_m");
  if (name == "uav") robot["min_height_m"] = 1.2;
  return robot.dump();
}

}  // namespace frontlux::test
