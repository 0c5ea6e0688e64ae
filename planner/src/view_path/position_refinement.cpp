#include "casting/counting_ray_caster.hpp"

#include <frontlux/planner/information_gain.hpp>
#include <frontlux/planner/path_planner.hpp>
#include <frontlux/planner/position_refinement.hpp>
#include <frontlux/planner/visible_pairs.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace frontlux::planner {
namespace {

constexpr double kFlat = 1e-9;      // gradient per unit of gain under which a path counts as stationary [1/m]
constexpr double kRounding = 1e-9;  // of the spacing, as the path planner keeps it

void check_count(const char* name, int value) {
  constexpr int kMost = 1000;
  if (value < 1 || value > kMost)
    throw std::invalid_argument(std::string("position refinement: ") + name + " is " + std::to_string(value) +
                                ", but has to be 1 to " + std::to_string(kMost));
}

void check_length(const char* name, double value) {
  if (!(value > 0.0) || !std::isfinite(value))
    throw std::invalid_argument(std::string("position refinement: ") + name + " is " + std::to_string(value) +
                                " m, but has to be finite and more than 0");
}

std::vector<double> yaws_of(std::span<const Pose> viewpoints) {
  std::vector<double> yaws;
  for (const Pose& viewpoint : viewpoints) yaws.push_back(viewpoint.yaw);
  return yaws;
}

// With all that a move could bring into view: only frontiers among the fixed pairs attract a viewpoint.
FieldOfView widened(FieldOfView view, double shift) {
  constexpr double kWidest = 3.1;  // [rad], since the opening has to stay below pi
  double& opening = view.shape == FieldOfView::Shape::kCone ? view.horizontal : view.vertical;
  // By as much as the shift turns the direction of what is at half of the range.
  opening = std::max(opening, std::min(kWidest, opening + 2.0 * std::atan(2.0 * shift / view.max_range)));
  view.max_range += shift;
  return view;
}

class Moves {
 public:
  Moves(std::span<const Pose> origin, const TravelCorridor& corridor, const Lattice& lattice, Motion motion,
        const PositionOptions& options)
      : origin_(origin), corridor_(corridor), lattice_(lattice), motion_(motion), options_(options) {}

  // The path after a step of each viewpoint between the ends, one after the other, as far as its neighbours
  // allow: the path is admissible after every step.
  [[nodiscard]] std::vector<Pose> moved(std::vector<Pose> path, std::span<const PoseGradient> gradient,
                                        double scale) const {
    constexpr int kHalvings = 4;
    for (std::size_t i = 1; i + 1 < path.size(); ++i) {
      Eigen::Vector3d step = scale * gradient[i].position;
      if (motion_ != Motion::kSpace) step.z() = 0.0;
      for (int n = 0; n < kHalvings && !step.isZero(0.0); ++n, step /= 2.0) {
        const Eigen::Vector3d to = within_reach(i, path[i].position + step);
        if (!admissible(path[i - 1].position, to) || !admissible(to, path[i + 1].position)) continue;
        path[i].position = to;
        break;
      }
    }
    return path;
  }

 private:
  [[nodiscard]] Eigen::Vector3d within_reach(std::size_t i, const Eigen::Vector3d& at) const {
    const Eigen::Vector3d shift = at - origin_[i].position;
    const double length = shift.norm();
    if (length <= options_.max_shift) return at;
    Eigen::Vector3d nearer = origin_[i].position + options_.max_shift / length * shift;
    if (motion_ != Motion::kSpace) nearer.z() = origin_[i].position.z();
    return nearer;
  }
  // The cells of both ends are among those that have to be passable.
  [[nodiscard]] bool admissible(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const {
    return (to - from).norm() <= options_.spacing * (1.0 + kRounding) &&
           segment_is_free(corridor_, lattice_, from, to);
  }

  std::span<const Pose> origin_;
  const TravelCorridor& corridor_;
  const Lattice& lattice_;
  Motion motion_;
  const PositionOptions& options_;
};

// Along the gradient; a step that does not raise the gain is tried again at half its length.
std::vector<Pose> climbed(const InformationGain& gain, std::vector<Pose> path, const Moves& moves,
                          const PositionOptions& options, bool plane) {
  std::vector<PoseGradient> gradient(path.size()), next(path.size());
  double value = gain.value_at(path, options.sharpness, gradient);
  double length = options.max_shift / 2.0;
  for (int n = 0; n < options.steps; ++n) {
    double steepest = 0.0;
    for (std::size_t i = 1; i + 1 < path.size(); ++i) {
      const Eigen::Vector3d& slope = gradient[i].position;
      steepest = std::max(steepest, plane ? slope.head<2>().norm() : slope.norm());
    }
    if (!(steepest > kFlat * value)) break;
    std::vector<Pose> trial = moves.moved(path, gradient, length / steepest);
    const double reached = gain.value_at(trial, options.sharpness, next);
    if (!(reached > value)) {
      length /= 2.0;
      continue;
    }
    value = reached;
    path.swap(trial);
    gradient.swap(next);
  }
  return path;
}

bool same_places(std::span<const Pose> a, std::span<const Pose> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Pose& one, const Pose& other) { return one.position == other.position; });
}

}  // namespace

void PositionOptions::check() const {
  check_count("outer_iterations", outer_iterations);
  check_count("steps", steps);
  check_length("max_shift", max_shift);
  check_length("spacing", spacing);
  check_sharpness(sharpness);
  optimizer.check();
}

RefinedPath refine_positions(std::span<const Pose> viewpoints, std::span<const VoxelKey> frontiers,
                             const RayCaster& caster, const VoxelGrid& grid, const TravelCorridor& corridor,
                             const Robot& robot, const PositionOptions& options) {
  options.check();
  robot.check();
  check_finite(viewpoints);
  const detail::CountingRayCaster counting(caster, grid.lattice());
  const auto targets = centers(grid.lattice(), frontiers);
  const FieldOfView wide = widened(robot.view, options.max_shift);
  const bool plane = robot.travel.drives();
  const Moves moves(viewpoints, corridor, grid.lattice(), robot.travel.motion, options);

  RefinedPath refined{{viewpoints.begin(), viewpoints.end()}, {}, {}, 0, 0};
  const InformationGain first(viewpoints, targets,
                              visible_pairs(counting, grid, viewpoints, frontiers, robot.view), robot.view,
                              options.optimizer.gain);
  const auto yaws = yaws_of(viewpoints);
  refined.before = {first.value(yaws, options.optimizer.sharpness.back()), first.distinct(yaws)};
  refined.after = refined.before;

  for (int n = 0; n < options.outer_iterations && viewpoints.size() > 2; ++n) {
    const InformationGain gain(refined.viewpoints, targets,
                               visible_pairs(counting, grid, refined.viewpoints, frontiers, wide), robot.view,
                               options.optimizer.gain);
    std::vector<Pose> path = climbed(gain, refined.viewpoints, moves, options, plane);
    if (same_places(path, refined.viewpoints)) break;

    const auto turned =
        optimize_path(path, targets, visible_pairs(counting, grid, path, frontiers, robot.view), robot.view,
                      options.optimizer);
    const auto& [fuzzy, distinct] = turned.result;
    const bool better = distinct > refined.after.distinct ||
                        (distinct == refined.after.distinct && fuzzy > refined.after.fuzzy);
    if (!better || turned.end == OptimizationEnd::kLimitsUnreachable) break;
    for (std::size_t i = 1; i + 1 < path.size(); ++i) path[i].yaw = turned.yaws[i];
    refined.viewpoints = std::move(path);
    refined.after = turned.result;
    ++refined.outer_iterations;
  }
  refined.rays = counting.rays();
  return refined;
}

}  // namespace frontlux::planner
