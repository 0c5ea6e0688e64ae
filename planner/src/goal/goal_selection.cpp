#include "goal/counting_ray_caster.hpp"
#include "goal/rendered_goal.hpp"
#include "goal/team_state.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <stdexcept>
#include <utility>

namespace frontlux::planner {
namespace {

using detail::GoalQuery;

void check(const TeamMember& member) {
  try {
    member.robot.check();
    member.options.check();
    if (member.robot.view.shape != FieldOfView::Shape::kSpinning &&
        member.options.rule != GoalRule::kNearest) {
      const std::vector<std::uint32_t> bins(static_cast<std::size_t>(member.options.rendering.azimuth_bins));
      static_cast<void>(best_window(bins, member.robot.view.horizontal));
    }
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("robot '" + member.robot.name + "': " + error.what());
  }
}

ViewQualityOptions rendering_of(const TeamMember& member, std::uint64_t seed) {
  ViewQualityOptions rendering = member.options.rendering;
  rendering.seed = seed;
  if (member.robot.view.shape == FieldOfView::Shape::kSpinning) rendering.azimuth_bins = 0;
  return rendering;
}

}  // namespace

TravelCorridor GoalSelection::State::new_corridor(const TeamMember& member) const {
  try {
    return {member.robot.travel, lattice, bounds};
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("robot '" + member.robot.name + "': " + error.what());
  }
}

void GoalSelection::State::renew_corridor(std::size_t robot) {
  members[robot].corridor = new_corridor(team[robot]);
  members[robot].corridor.block(members[robot].blocked);
  members[robot].unseen.forget();
}

void GoalSelection::State::update(const MapChange& change, std::span<const Pose> poses) {
  for (std::size_t r = 0; r < members.size(); ++r) {
    Member& member = members[r];
    member.position = poses[r].position;
    member.rendered = false;
    member.share.clear();
    member.abandoned.clear();
    member.targets.clear();
    if (member.image.size() > 0) {
      Keys changed;
      std::ranges::set_union(member.changed, change.keys, std::back_inserter(changed));
      member.changed = std::move(changed);
    }
    const auto cell = lattice.key(member.position);
    if (!cell) {
      renew_corridor(r);  // which, not updated, has no cells
      continue;
    }
    member.cell = *cell;
    member.corridor.update(change, member.cell);
    member.unseen.update(change, member.corridor.cells(),
                         ViewRegion(team[r].robot.view, lattice.resolution()));
  }
}

GoalSelection::GoalSelection(std::vector<TeamMember> team, const Lattice& lattice, const KeyBox& bounds,
                             bool distribute)
    : state_(std::make_unique<State>(State{std::move(team), lattice, bounds, distribute, {}})) {
  for (std::size_t r = 0; r < state_->team.size(); ++r) {
    const TeamMember& member = state_->team[r];
    check(member);
    // Robots draw different numbers at the same place.
    const std::uint64_t seed = member.options.rendering.seed + r * 0x9E3779B97F4A7C15U;
    State::Member state{state_->new_corridor(member),
                        ViewQualityImage(lattice, member.robot.view, rendering_of(member, seed))};
    state_->members.push_back(std::move(state));
  }
}
GoalSelection::~GoalSelection() = default;
GoalSelection::GoalSelection(GoalSelection&&) noexcept = default;
GoalSelection& GoalSelection::operator=(GoalSelection&&) noexcept = default;

TeamGoals GoalSelection::select(const RayCaster& caster, const MapChange& change,
                                std::span<const VoxelKey> frontiers, std::span<const Pose> poses) {
  State& state = *state_;
  const VoxelGrid& grid = change.grid;
  if (poses.size() != state.team.size())
    throw std::invalid_argument("goal selection: " + std::to_string(poses.size()) + " poses for " +
                                std::to_string(state.team.size()) + " robots");
  for (std::size_t r = 0; r < poses.size(); ++r)
    if (!poses[r].position.allFinite() || !std::isfinite(poses[r].yaw))
      throw std::invalid_argument("goal selection: the pose of robot '" + state.team[r].robot.name +
                                  "' is not finite");
  if (grid.resolution() != state.lattice.resolution())
    throw std::invalid_argument("goal selection: the grid has a resolution of " +
                                std::to_string(grid.resolution()) + " m, the robots were told " +
                                std::to_string(state.lattice.resolution()) + " m");
  State::Keys sorted(frontiers.begin(), frontiers.end());
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());

  const detail::CountingRayCaster counting(caster, state.lattice);
  TeamGoals result;
  result.frontiers = sorted.size();
  result.goals.resize(poses.size());
  state.update(change, poses);
  for (std::size_t r = 0; r < poses.size(); ++r) {
    Goal& goal = result.goals[r];
    const CorridorState corridor = state.members[r].corridor.state();
    goal.state = corridor == CorridorState::kReady ? GoalState::kNoFrontiers : GoalState::kNoCorridor;
    goal.reason = corridor == CorridorState::kReady ? "no goal: the map has no frontiers"
                  : corridor == CorridorState::kNotUpdated
                      ? "no goal: the robot is outside the key range"
                      : "no goal: the robot " + std::string(describe(corridor));
  }
  if (!sorted.empty()) {
    state.distribute(counting, grid, sorted, result);
    state.decide(counting, grid, result);
  }
  result.rays = counting.rays();
  return result;
}

void GoalSelection::block(std::size_t robot, std::span<const VoxelKey> cells) {
  State::Member& member = state_->members[robot];
  member.blocked.insert(member.blocked.end(), cells.begin(), cells.end());
  member.corridor.block(cells);
}

const std::vector<TeamMember>& GoalSelection::team() const { return state_->team; }
const TravelCorridor& GoalSelection::corridor(std::size_t robot) const {
  return state_->members[robot].corridor;
}
std::span<const VoxelKey> GoalSelection::targets(std::size_t robot) const {
  return state_->members[robot].targets;
}

std::vector<RenderedCell> GoalSelection::rendered_cells(std::size_t robot) const {
  const State::Member& member = state_->members[robot];
  std::vector<RenderedCell> cells;
  if (!member.rendered) return cells;
  // Rating asks no caster; this one only stands where a query has one.
  const auto caster = make_grid_ray_caster(VoxelGrid(state_->lattice.resolution()));
  const GoalQuery asked = state_->query(*caster, robot, member.targets);
  cells.reserve(member.image.size());
  for (std::size_t i = 0; i < member.image.size(); ++i) cells.push_back(detail::rate(asked, member.image, i));
  std::sort(cells.begin(), cells.end(),
            [](const RenderedCell& a, const RenderedCell& b) { return a.cell < b.cell; });
  return cells;
}

}  // namespace frontlux::planner
