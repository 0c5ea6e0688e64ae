#pragma once

#include "routing/measured_tours.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace frontlux::planner::detail {

/// Shortens tours by stretches in the opposite order.
class TwoOpt {
 public:
  /// @pre the tours outlive it
  explicit TwoOpt(MeasuredTours& tours) : tours_(tours), searched_(tours.tours.size()) {}

  /// Looks once at each stretch of each tour. @return whether a tour has changed
  bool reverse_stretches();

 private:
  bool reverse_stretches_of(std::size_t robot);
  [[nodiscard]] std::vector<std::uint8_t> new_steps(std::size_t robot) const;

  MeasuredTours& tours_;
  // `stops_after` of each tour when no stretch was worth it; empty if that was never.
  std::vector<std::vector<std::uint32_t>> searched_;
};

}  // namespace frontlux::planner::detail
