#pragma once

#include <frontlux/planner/exploration.hpp>

#include <chrono>
#include <cstddef>

namespace frontlux::planner::detail {

/// Adds the time that it lives to a phase.
class PhaseClock {
 public:
  PhaseClock(ExplorationStep& step, Phase phase) : seconds_(step.seconds[static_cast<std::size_t>(phase)]) {}
  ~PhaseClock() {
    seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }
  PhaseClock(const PhaseClock&) = delete;
  PhaseClock& operator=(const PhaseClock&) = delete;

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace frontlux::planner::detail
