#include "path/sampling_search.hpp"

#include "path/flat_points.hpp"

#include <ompl/base/MotionValidator.h>
#include <ompl/base/PlannerTerminationCondition.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/ScopedState.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/StateSampler.h>
#include <ompl/base/objectives/PathLengthOptimizationObjective.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/datastructures/NearestNeighbors.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/rrt/RRT.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>
#include <ompl/util/Console.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <mutex>
#include <utility>

namespace frontlux::planner::detail {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

using RealState = ob::RealVectorStateSpace::StateType;
using WayIsFree = std::function<bool(const Eigen::Vector3d&, const Eigen::Vector3d&)>;

// While one lives OMPL says nothing. The level and not the output handler is changed: of handlers OMPL
// remembers just one before the present one, which is the embedding program's to come back to.
class Silence {
 public:
  Silence() {
    const std::lock_guard lock(mutex());
    if (count()++ == 0) {
      before() = ompl::msg::getLogLevel();
      ompl::msg::setLogLevel(ompl::msg::LOG_NONE);
    }
  }
  ~Silence() {
    const std::lock_guard lock(mutex());
    if (--count() == 0) ompl::msg::setLogLevel(before());
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex the_mutex;
    return the_mutex;
  }
  static int& count() {
    static int the_count = 0;
    return the_count;
  }
  static ompl::msg::LogLevel& before() {
    static ompl::msg::LogLevel the_level = ompl::msg::LOG_NONE;
    return the_level;
  }
};

template <std::size_t N>
std::array<double, N> coordinates(const ob::State* state) {
  std::array<double, N> point;
  std::copy_n(state->as<RealState>()->values, N, point.begin());
  return point;
}

// On a plane states have two coordinates, and all are at one height.
struct Points {
  bool plane;
  double height;  // [m] of the plane

  [[nodiscard]] Eigen::Vector3d operator()(const ob::State* state) const {
    const double* at = state->as<RealState>()->values;
    return {at[0], at[1], plane ? height : at[2]};
  }
  void write(const Eigen::Vector3d& point, ob::State* state) const {
    std::copy_n(point.data(), plane ? 2 : 3, state->as<RealState>()->values);
  }
};

// OMPL's own neighbours start from random pivots, and of two equally near they return one or the other.
template <std::size_t N>
struct Neighbors {
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
      points_.add(coordinates<N>(motion->state));
      motions_.push_back(motion);
    }
    bool remove(const Motion& motion) override {
      const auto found = std::find(motions_.begin(), motions_.end(), motion);
      if (found == motions_.end()) return false;
      points_.remove(static_cast<std::size_t>(found - motions_.begin()));
      motions_.erase(found);
      return true;
    }
    Motion nearest(const Motion& motion) const override {
      return motions_[points_.nearest(coordinates<N>(motion->state))];
    }
    void nearestK(const Motion& motion, std::size_t k, std::vector<Motion>& found) const override {
      copy(points_.nearest(coordinates<N>(motion->state), k, std::numeric_limits<double>::infinity()), found);
    }
    void nearestR(const Motion& motion, double radius, std::vector<Motion>& found) const override {
      copy(points_.nearest(coordinates<N>(motion->state), motions_.size(), radius), found);
    }
    [[nodiscard]] std::size_t size() const override { return motions_.size(); }
    void list(std::vector<Motion>& all) const override { all = motions_; }

   private:
    void copy(const std::vector<std::size_t>& indices, std::vector<Motion>& found) const {
      found.clear();
      for (const std::size_t i : indices) found.push_back(motions_[i]);
    }

    FlatPoints<N> points_;
    std::vector<Motion> motions_;
  };
};

// Uniform over the cells, so that no sample is wasted on walls and rooms unseen. One too near to the side of
// its cell moves towards the middle, so that passages of a single cell get their share.
class CellSampler : public ob::StateSampler {
 public:
  CellSampler(const ob::StateSpace* space, const Lattice& lattice, const TreeQuery& query,
              const WayIsFree& way_is_free)
      : ob::StateSampler(space),
        lattice_(lattice),
        cells_(query.cells),
        points_{query.plane, query.start.z()},
        reaches_(query.reach != Eigen::Vector3d::Zero()),
        sure_(Eigen::Vector3d::Ones() - 2.0 / lattice.resolution() * query.reach),
        way_is_free_(way_is_free),
        state_(query.seed) {}

  void sampleUniform(ob::State* state) override {
    const auto n = static_cast<double>(cells_.size());
    const VoxelKey& cell = cells_[std::min(static_cast<std::size_t>(uniform() * n), cells_.size() - 1)];
    const auto within = [this](std::uint16_t key) {
      return lattice_.center(key) + (uniform() - 0.5) * kPart * lattice_.resolution();
    };
    const double x = within(cell.x), y = within(cell.y), z = within(cell.z);
    points_.write({x, y, z}, state);
    if (!reaches_ || way_is_free_(points_(state), points_(state))) return;
    const Eigen::Vector3d middle(lattice_.center(cell.x), lattice_.center(cell.y), lattice_.center(cell.z));
    points_.write(middle + sure_.cwiseProduct(Eigen::Vector3d(x, y, z) - middle), state);
  }
  // No search here asks for these; they stay in the bounds of the space, cell or not.
  void sampleUniformNear(ob::State* state, const ob::State* near, double distance) override {
    const Eigen::Vector3d middle = points_(near);
    const auto along = [&](double at) { return at + (2.0 * uniform() - 1.0) * distance; };
    const double x = along(middle.x()), y = along(middle.y()), z = along(middle.z());
    points_.write({x, y, z}, state);
    space_->enforceBounds(state);
  }
  void sampleGaussian(ob::State* state, const ob::State* mean, double deviation) override {
    const Eigen::Vector3d middle = points_(mean);
    // Twelve uniform numbers have a variance of one.
    const auto along = [&](double at) {
      double sum = -6.0;
      for (int i = 0; i < 12; ++i) sum += uniform();
      return at + deviation * sum;
    };
    const double x = along(middle.x()), y = along(middle.y()), z = along(middle.z());
    points_.write({x, y, z}, state);
    space_->enforceBounds(state);
  }

 private:
  static constexpr double kPart = 0.98;  // of a voxel: a sample keeps off the faces

  // SplitMix64. The standard's distributions differ from library to library.
  double uniform() {
    std::uint64_t bits = state_ += 0x9E3779B97F4A7C15;
    bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9;
    bits = (bits ^ (bits >> 27)) * 0x94D049BB133111EB;
    return static_cast<double>((bits ^ (bits >> 31)) >> 11) * 0x1p-53;
  }

  const Lattice& lattice_;
  std::span<const VoxelKey> cells_;
  Points points_;
  bool reaches_;
  Eigen::Vector3d sure_;  // part of a voxel, around its middle, in which only this voxel counts
  const WayIsFree& way_is_free_;
  std::uint64_t state_;
};

// Asks for the whole way: OMPL would look at points some hundredth of the space apart.
class WayValidator : public ob::MotionValidator {
 public:
  WayValidator(const ob::SpaceInformationPtr& space, const WayIsFree& way_is_free, const Points& points)
      : ob::MotionValidator(space), way_is_free_(way_is_free), points_(points) {}

  bool checkMotion(const ob::State* from, const ob::State* to) const override {
    return way_is_free_(points_(from), points_(to));
  }
  // Of a blocked way only the beginning is vouched for.
  bool checkMotion(const ob::State* from, const ob::State* to,
                   std::pair<ob::State*, double>& last_valid) const override {
    if (checkMotion(from, to)) return true;
    if (last_valid.first != nullptr) si_->copyState(last_valid.first, from);
    last_valid.second = 0.0;
    return false;
  }

 private:
  const WayIsFree& way_is_free_;
  Points points_;
};

// OMPL draws the seed of a planner's own random numbers from one sequence for the whole process.
template <class Planner>
class Seeded : public Planner {
 public:
  Seeded(const ob::SpaceInformationPtr& space, std::uint64_t seed) : Planner(space) {
    this->rng_.setLocalSeed(static_cast<std::uint32_t>(seed ^ (seed >> 32)));
  }
};

template <class Planner>
ob::PlannerPtr make_planner(const ob::SpaceInformationPtr& space, const TreeQuery& query,
                            const PathOptions& options) {
  const auto planner = std::make_shared<Seeded<Planner>>(space, query.seed);
  planner->setRange(options.range);
  if constexpr (requires { planner->setGoalBias(0.0); }) planner->setGoalBias(options.goal_bias);
  if (query.plane)
    planner->template setNearestNeighbors<Neighbors<2>::template Of>();
  else
    planner->template setNearestNeighbors<Neighbors<3>::template Of>();
  return planner;
}

ob::PlannerPtr make_planner(const ob::SpaceInformationPtr& space, const TreeQuery& query,
                            const PathOptions& options) {
  switch (options.search) {
    case PathSearch::kRrtConnect:
      return make_planner<og::RRTConnect>(space, query, options);
    case PathSearch::kRrtStar:
      return make_planner<og::RRTstar>(space, query, options);
    default:
      return make_planner<og::RRT>(space, query, options);
  }
}

// The box around the cells, and a voxel more.
ob::RealVectorBounds bounds_of(const Lattice& lattice, const TreeQuery& query) {
  std::array<int, 3> low, high;
  low.fill(std::numeric_limits<int>::max());
  high.fill(std::numeric_limits<int>::min());
  for (const VoxelKey& cell : query.cells) {
    const std::array<int, 3> key = {cell.x, cell.y, cell.z};
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], key[a]);
      high[a] = std::max(high[a], key[a]);
    }
  }
  const unsigned dimensions = query.plane ? 2 : 3;
  ob::RealVectorBounds bounds(dimensions);
  for (unsigned a = 0; a < dimensions; ++a) {
    bounds.setLow(a, (low[a] - 1 - Lattice::kOrigin) * lattice.resolution());
    bounds.setHigh(a, (high[a] + 2 - Lattice::kOrigin) * lattice.resolution());
  }
  return bounds;
}

}  // namespace

TreeAnswer search_tree(const Lattice& lattice, const TreeQuery& query, const PathOptions& options,
                       const WayIsFree& way_is_free) {
  const Silence silence;
  const Points points{query.plane, query.start.z()};
  const auto space = std::make_shared<ob::RealVectorStateSpace>(query.plane ? 2U : 3U);
  space->setBounds(bounds_of(lattice, query));
  space->setStateSamplerAllocator([&](const ob::StateSpace* of) {
    return std::make_shared<CellSampler>(of, lattice, query, way_is_free);
  });
  const auto information = std::make_shared<ob::SpaceInformation>(space);
  information->setStateValidityChecker(
      [&](const ob::State* state) { return way_is_free(points(state), points(state)); });
  information->setMotionValidator(std::make_shared<WayValidator>(information, way_is_free, points));
  information->setup();

  ob::ScopedState<> start(space), goal(space);
  points.write(query.start, start.get());
  points.write(query.goal, goal.get());
  const auto problem = std::make_shared<ob::ProblemDefinition>(information);
  problem->setStartAndGoalStates(start, goal);
  problem->setOptimizationObjective(std::make_shared<ob::PathLengthOptimizationObjective>(information));

  const ob::PlannerPtr planner = make_planner(information, query, options);
  planner->setProblemDefinition(problem);
  planner->setup();
  int iterations = 0;
  const ob::PlannerStatus status = planner->solve(ob::PlannerTerminationCondition([&] {
    if (iterations == options.iterations) return true;
    ++iterations;
    return false;
  }));

  TreeAnswer answer;
  answer.iterations = iterations;
  if (status != ob::PlannerStatus::EXACT_SOLUTION) return answer;
  for (const ob::State* state : problem->getSolutionPath()->as<og::PathGeometric>()->getStates())
    answer.way.push_back(points(state));
  return answer;
}

}  // namespace frontlux::planner::detail
