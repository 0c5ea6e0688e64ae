#pragma once

#include "routing/tour_problem.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace frontlux::planner::detail {

/// [s] Smaller gains are rounding.
inline constexpr double kCostRounding = 1e-6;
/// Instead of a stop: none, and the end of a tour.
inline constexpr std::uint32_t kNoStop = ~std::uint32_t{0}, kEndOfTour = kNoStop - 1;

/// Tours and how long they take. Who changes a tour measures it again.
struct MeasuredTours {
  using Steps = std::vector<double>;

  const TourProblem& problem;
  Tours tours;                  ///< of each robot
  std::vector<Steps> steps;     ///< [s] of each tour: to each of its stops from the one before
  std::vector<double> lengths;  ///< [s] of each tour

  /// @param given  tours of the first robots; those of the others are empty @pre problem outlives the tours
  MeasuredTours(const TourProblem& of, Tours given);

  void measure(std::size_t robot);

  /// [s] The longest tour, and a part of the sum of all.
  [[nodiscard]] double cost() const;
  /// The same if the tours of two robots, or of one given twice, took another time [s].
  [[nodiscard]] double cost_with(std::size_t a, double length_a, std::size_t b, double length_b) const;

  /// The first place of a tour at which a stop may be taken in.
  [[nodiscard]] std::size_t first_free_place(std::size_t robot) const;
  /// [s] What a robot needs more for a stretch, from its first to its last stop, before place `at` of a tour;
  /// the time within the stretch is left out.
  /// @param tour, its_steps  the robot's, or another one for it
  [[nodiscard]] double detour(std::size_t robot, const Tour& tour, const Steps& its_steps, std::size_t at,
                              std::uint32_t first, std::uint32_t last) const;
  /// The stop that follows each one in a tour, and the start of the tour, which comes last.
  [[nodiscard]] std::vector<std::uint32_t> stops_after(std::size_t robot) const;
};

}  // namespace frontlux::planner::detail
