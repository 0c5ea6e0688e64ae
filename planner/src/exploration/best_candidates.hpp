#pragma once

#include <frontlux/planner/goal_selection.hpp>

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <utility>
#include <vector>

namespace frontlux::planner::detail {

/// The goal's cell and the best others by eq. 1, sorted by cell. There are thousands in space, and most are
/// worth next to nothing.
[[nodiscard]] inline std::vector<RenderedCell> best_candidates(std::vector<RenderedCell> cells,
                                                               const Goal& goal) {
  constexpr std::size_t kMost = 1000;
  if (cells.size() <= kMost) {
    std::ranges::stable_sort(cells, {}, &RenderedCell::cell);
    return cells;
  }
  const auto by_cell = [](const RenderedCell& a, const RenderedCell& b) {
    return std::tie(a.cell, a.yaw) < std::tie(b.cell, b.yaw);
  };
  const auto worth = [&](const RenderedCell& cell) {
    return std::pair(cell.cell == goal.cell, cell.quality);
  };
  std::ranges::nth_element(cells, cells.begin() + kMost, [&](const RenderedCell& a, const RenderedCell& b) {
    return worth(a) != worth(b) ? worth(a) > worth(b) : by_cell(a, b);
  });
  cells.resize(kMost);
  std::ranges::sort(cells, by_cell);
  return cells;
}

}  // namespace frontlux::planner::detail
