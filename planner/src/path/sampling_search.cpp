#include "path/sampling_search.hpp"

#include "path/nearest_motions.hpp"

#include <frontlux/key_box.hpp>
#include <frontlux/split_mix.hpp>

#include <ompl/base/MotionValidator.h>
#include <ompl/base/PlannerTerminationCondition.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/ScopedState.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/StateSampler.h>
#include <ompl/base/objectives/PathLengthOptimizationObjective.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/rrt/RRT.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>
#include <ompl/util/Console.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <mutex>
#include <utility>

namespace frontlux::planner::detail {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

using RealState = ob::RealVectorStateSpace::StateType;

// OMPL logs nothing while an object of this class exists. It changes the log level and not the output
// handler: OMPL remembers only one earlier handler, which is for the embedding program to restore.
class Silence {
 public:
  Silence() {
    const std::lock_guard lock(mutex_);
    if (count_++ != 0) return;
    before_ = ompl::msg::getLogLevel();
    ompl::msg::setLogLevel(ompl::msg::LOG_NONE);
  }
  ~Silence() {
    const std::lock_guard lock(mutex_);
    if (--count_ == 0) ompl::msg::setLogLevel(before_);
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  inline static std::mutex mutex_;
  inline static int count_ = 0;
  inline static ompl::msg::LogLevel before_ = ompl::msg::LOG_NONE;
};

// States as points. On a plane states have two coordinates, and all points are at one height.
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

// Uniform over the cells, so that no sample falls on walls and unknown rooms. A sample too near to the side
// of its cell moves towards the middle, so that passages of a single cell are sampled, too.
class CellSampler : public ob::StateSampler {
 public:
  CellSampler(const ob::StateSpace* space, const Lattice& lattice, const SamplingQuery& query,
              const SegmentCheck& is_free)
      : ob::StateSampler(space),
        lattice_(lattice),
        cells_(query.cells),
        points_{query.plane, query.start.z()},
        reaches_(query.reach != Eigen::Vector3d::Zero()),
        inner_(Eigen::Vector3d::Ones() - 2.0 / lattice.resolution() * query.reach),
        is_free_(is_free),
        random_(query.seed) {}

  void sampleUniform(ob::State* state) override {
    const auto n = static_cast<double>(cells_.size());
    const VoxelKey& cell = cells_[std::min(static_cast<std::size_t>(random_.unit() * n), cells_.size() - 1)];
    const auto within = [this](std::uint16_t key) {
      return lattice_.center(key) + (random_.unit() - 0.5) * kPart * lattice_.resolution();
    };
    const double x = within(cell.x), y = within(cell.y), z = within(cell.z);
    points_.write({x, y, z}, state);
    if (!reaches_ || is_free_(points_(state), points_(state))) return;
    const Eigen::Vector3d middle = lattice_.exact_center(cell);
    points_.write(middle + inner_.cwiseProduct(Eigen::Vector3d(x, y, z) - middle), state);
  }
  // The searches used here call neither of these. Their samples stay in the bounds of the space.
  void sampleUniformNear(ob::State* state, const ob::State* near, double distance) override {
    const Eigen::Vector3d middle = points_(near);
    const auto along = [&](double at) { return at + random_.between(-distance, distance); };
    const double x = along(middle.x()), y = along(middle.y()), z = along(middle.z());
    points_.write({x, y, z}, state);
    space_->enforceBounds(state);
  }
  void sampleGaussian(ob::State* state, const ob::State* mean, double deviation) override {
    sampleUniformNear(state, mean, std::sqrt(3.0) * deviation);  // of the same deviation
  }

 private:
  static constexpr double kPart = 0.98;  // of a voxel: a sample keeps off the faces

  const Lattice& lattice_;
  std::span<const VoxelKey> cells_;
  Points points_;
  bool reaches_;
  Eigen::Vector3d inner_;  // part of a voxel, around its middle, in which only this voxel counts
  const SegmentCheck& is_free_;
  SplitMix64 random_;
};

// Checks the whole segment: OMPL would check points some hundredth of the space apart.
class SegmentValidator : public ob::MotionValidator {
 public:
  SegmentValidator(const ob::SpaceInformationPtr& space, const SegmentCheck& is_free, const Points& points)
      : ob::MotionValidator(space), is_free_(is_free), points_(points) {}

  bool checkMotion(const ob::State* from, const ob::State* to) const override {
    return is_free_(points_(from), points_(to));
  }
  // Of a blocked segment only the beginning is known to be valid.
  bool checkMotion(const ob::State* from, const ob::State* to,
                   std::pair<ob::State*, double>& last_valid) const override {
    if (checkMotion(from, to)) return true;
    if (last_valid.first != nullptr) si_->copyState(last_valid.first, from);
    last_valid.second = 0.0;
    return false;
  }

 private:
  const SegmentCheck& is_free_;
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
ob::PlannerPtr make_planner(const ob::SpaceInformationPtr& space, const SamplingQuery& query,
                            const PathOptions& options) {
  const auto planner = std::make_shared<Seeded<Planner>>(space, query.seed);
  planner->setRange(options.range);
  if constexpr (requires { planner->setGoalBias(0.0); }) planner->setGoalBias(options.goal_bias);
  if (query.plane)
    planner->template setNearestNeighbors<NearestMotions<2>::template Of>();
  else
    planner->template setNearestNeighbors<NearestMotions<3>::template Of>();
  return planner;
}

ob::PlannerPtr make_planner(const ob::SpaceInformationPtr& space, const SamplingQuery& query,
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
ob::RealVectorBounds search_bounds(const Lattice& lattice, const SamplingQuery& query) {
  const KeyBox box = bounds_of(query.cells);
  const std::array<int, 3> low = {box.min.x, box.min.y, box.min.z}, high = {box.max.x, box.max.y, box.max.z};
  const unsigned dimensions = query.plane ? 2 : 3;
  ob::RealVectorBounds bounds(dimensions);
  for (unsigned a = 0; a < dimensions; ++a) {
    bounds.setLow(a, (low[a] - 1 - Lattice::kOrigin) * lattice.resolution());
    bounds.setHigh(a, (high[a] + 2 - Lattice::kOrigin) * lattice.resolution());
  }
  return bounds;
}

}  // namespace

SamplingResult sampling_search(const Lattice& lattice, const SamplingQuery& query, const PathOptions& options,
                               const SegmentCheck& is_free) {
  const Silence silence;
  const Points points{query.plane, query.start.z()};
  const auto space = std::make_shared<ob::RealVectorStateSpace>(query.plane ? 2U : 3U);
  space->setBounds(search_bounds(lattice, query));
  space->setStateSamplerAllocator(
      [&](const ob::StateSpace* of) { return std::make_shared<CellSampler>(of, lattice, query, is_free); });
  const auto information = std::make_shared<ob::SpaceInformation>(space);
  information->setStateValidityChecker(
      [&](const ob::State* state) { return is_free(points(state), points(state)); });
  information->setMotionValidator(std::make_shared<SegmentValidator>(information, is_free, points));
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

  SamplingResult result;
  result.iterations = iterations;
  if (status != ob::PlannerStatus::EXACT_SOLUTION) return result;
  for (const ob::State* state : problem->getSolutionPath()->as<og::PathGeometric>()->getStates())
    result.path.push_back(points(state));
  return result;
}

}  // namespace frontlux::planner::detail
