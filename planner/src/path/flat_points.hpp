#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace frontlux::planner::detail {

/// Points of N coordinates [m] in the order in which they came, and which of them are nearest to another
/// point. Exact, and of points equally near the first counts. The trees that need it have some thousand
/// points, which are read faster in a row than found in a tree of their own.
template <std::size_t N>
class FlatPoints {
 public:
  using Point = std::array<double, N>;

  [[nodiscard]] std::size_t size() const { return points_.size(); }
  void clear() { points_.clear(); }
  void add(const Point& point) { points_.push_back(point); }
  void remove(std::size_t index) { points_.erase(points_.begin() + static_cast<std::ptrdiff_t>(index)); }

  /// @pre there are points
  [[nodiscard]] std::size_t nearest(const Point& to) const {
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const double squared = squared_distance(points_[i], to);
      if (squared < least) {
        least = squared;
        best = i;
      }
    }
    return best;
  }

  /// At most `count` of them within a distance [m], the nearest first.
  [[nodiscard]] std::vector<std::size_t> nearest(const Point& to, std::size_t count, double radius) const {
    std::vector<std::pair<double, std::size_t>> found;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const double squared = squared_distance(points_[i], to);
      if (squared <= radius * radius) found.emplace_back(squared, i);
    }
    count = std::min(count, found.size());
    std::partial_sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count), found.end());
    std::vector<std::size_t> indices(count);
    for (std::size_t i = 0; i < count; ++i) indices[i] = found[i].second;
    return indices;
  }

 private:
  static double squared_distance(const Point& a, const Point& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < N; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return sum;
  }

  std::vector<Point> points_;
};

}  // namespace frontlux::planner::detail
