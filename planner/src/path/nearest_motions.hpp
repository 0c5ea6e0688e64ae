#pragma once

#include <ompl/base/State.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/datastructures/NearestNeighbors.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace frontlux::planner::detail {

/// The motions of OMPL's planners by their N coordinates [m], and which are nearest to another one. Exact; of
/// motions equally near, the one added first comes first. OMPL's own structures start from random pivots, and
/// return any of those equally near. A search has some thousand motions, and reading them in a row is faster
/// than a tree of points.
template <std::size_t N>
struct NearestMotions {
  template <class Motion>
  class Of : public ompl::NearestNeighbors<Motion> {
   public:
    using ompl::NearestNeighbors<Motion>::add;
    [[nodiscard]] bool reportsSortedResults() const override { return true; }
    void clear() override {
      points_.clear();
      motions_.clear();
    }
    void add(const Motion& motion) override {
      points_.push_back(point_of(motion));
      motions_.push_back(motion);
    }
    bool remove(const Motion& motion) override {
      const auto found = std::find(motions_.begin(), motions_.end(), motion);
      if (found == motions_.end()) return false;
      points_.erase(points_.begin() + (found - motions_.begin()));
      motions_.erase(found);
      return true;
    }
    Motion nearest(const Motion& motion) const override {
      const Point to = point_of(motion);
      std::size_t best = 0;
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < points_.size(); ++i)
        if (const double squared = squared_distance(points_[i], to); squared < least) {
          least = squared;
          best = i;
        }
      return motions_[best];
    }
    void nearestK(const Motion& motion, std::size_t k, std::vector<Motion>& found) const override {
      find(motion, k, std::numeric_limits<double>::infinity(), found);
    }
    void nearestR(const Motion& motion, double radius, std::vector<Motion>& found) const override {
      find(motion, motions_.size(), radius, found);
    }
    [[nodiscard]] std::size_t size() const override { return motions_.size(); }
    void list(std::vector<Motion>& all) const override { all = motions_; }

   private:
    using Point = std::array<double, N>;

    static Point point_of(const Motion& motion) {
      Point point;
      std::copy_n(motion->state->template as<ompl::base::RealVectorStateSpace::StateType>()->values, N,
                  point.begin());
      return point;
    }
    static double squared_distance(const Point& a, const Point& b) {
      double sum = 0.0;
      for (std::size_t i = 0; i < N; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
      return sum;
    }
    // At most `count` within a distance, the nearest first.
    void find(const Motion& motion, std::size_t count, double radius, std::vector<Motion>& found) const {
      const Point to = point_of(motion);
      std::vector<std::pair<double, std::size_t>> near;
      for (std::size_t i = 0; i < points_.size(); ++i)
        if (const double squared = squared_distance(points_[i], to); squared <= radius * radius)
          near.emplace_back(squared, i);
      count = std::min(count, near.size());
      std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
      found.clear();
      for (std::size_t i = 0; i < count; ++i) found.push_back(motions_[near[i].second]);
    }

    std::vector<Point> points_;
    std::vector<Motion> motions_;
  };
};

}  // namespace frontlux::planner::detail
