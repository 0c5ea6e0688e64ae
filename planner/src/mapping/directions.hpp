#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace frontlux::planner::detail {

/// Directions in cubic cells, to find those about a given one.
class Directions {
 public:
  /// Those at less than this from a direction of unit length are found.
  static constexpr float kFound = 0.9F / 16;

  explicit Directions(std::span<const Eigen::Vector3f> directions)
      : begins_(kEdge * kEdge * kEdge + 1), order_(directions.size()) {
    std::vector<std::size_t> cells;
    cells.reserve(directions.size());
    for (const Eigen::Vector3f& direction : directions) cells.push_back(number_of(cell_of(direction)));
    for (const std::size_t cell : cells) ++begins_[cell + 1];
    for (std::size_t i = 1; i < begins_.size(); ++i) begins_[i] += begins_[i - 1];
    std::vector<std::uint32_t> next = begins_;
    for (std::size_t i = 0; i < cells.size(); ++i) order_[next[cells[i]]++] = static_cast<std::uint32_t>(i);
  }

  /// Calls `visit` with the number of each direction that differs by up to a cell in each coordinate, and of
  /// some others.
  template <class Visit>
  void for_each_near(const Eigen::Vector3f& direction, const Visit& visit) const {
    const Eigen::Vector3i cell = cell_of(direction);
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y) {
        // Cells along z follow each other.
        const std::size_t first = number_of(cell + Eigen::Vector3i(x, y, -1));
        for (std::uint32_t i = begins_[first]; i < begins_[first + 3]; ++i) visit(order_[i]);
      }
  }

 private:
  static constexpr float kCells = 16;  // from 0 to 1
  static constexpr int kMiddle = 18;   // cell of 0: room for -1 to 1, and a cell more on each side
  static constexpr int kEdge = 2 * kMiddle + 1;

  static Eigen::Vector3i cell_of(const Eigen::Vector3f& direction) {
    return ((direction * kCells).array().floor().cast<int>() + kMiddle).matrix();
  }
  static std::size_t number_of(const Eigen::Vector3i& cell) {
    return static_cast<std::size_t>((cell.x() * kEdge + cell.y()) * kEdge + cell.z());
  }

  std::vector<std::uint32_t> begins_;  // in `order_`, of each cell
  std::vector<std::uint32_t> order_;
};

}  // namespace frontlux::planner::detail
