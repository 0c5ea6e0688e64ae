#pragma once

#include "command.hpp"

#include <frontlux/planner/mapping.hpp>

namespace frontlux::app {

inline void add_sensor_model_option(Command& command, planner::SensorModel& model) {
  command.add("--sensor-model", model,
              "What scans say of a voxel: as OctoMap has it, or that a ray which ends in it\n"
              "outweighs five scans that pass it");
}

}  // namespace frontlux::app
