#pragma once

#include <algorithm>
#include <vector>

namespace frontlux::planner::detail {

/// Sorts, and leaves one of those that are equal.
template <class Value>
void sort_once(std::vector<Value>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace frontlux::planner::detail
