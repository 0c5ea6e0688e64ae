#include "casting/counting_ray_caster.hpp"
#include "goal/goal_selection_state.hpp"
#include "goal/rendered_cell.hpp"
#include "mapping/sort_once.hpp"

#include <frontlux/planner/goal_selection.hpp>
#include <frontlux/split_mix.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace frontlux::planner {
namespace {

[[noreturn]] void refuse(const std::string& what) { throw std::invalid_argument("goal selection: " + what); }

void check(const TeamMember& member) {
  member.robot.check();
  member.options.check();
  if (member.robot.view.sees_all_around() || member.options.rule == GoalRule::kNearest) return;
  const std::vector<std::uint32_t> bins(static_cast<std::size_t>(member.options.rendering.azimuth_bins));
  static_cast<void>(best_window(bins, member.robot.view.horizontal));
}

ViewQualityOptions rendering_of(const TeamMember& member, std::size_t robot) {
  ViewQualityOptions rendering = member.options.rendering;
  rendering.seed += robot * SplitMix64::kStep;  // robots draw different numbers at the same place
  if (member.robot.view.sees_all_around()) rendering.azimuth_bins = 0;
  return rendering;
}

void set_no_goal(Goal& goal, CorridorState corridor) {
  goal.state = corridor == CorridorState::kReady ? GoalState::kNoFrontiers : GoalState::kNoCorridor;
  goal.reason = corridor == CorridorState::kReady ? "no goal: the map has no frontiers"
                : corridor == CorridorState::kNotUpdated
                    ? "no goal: the robot is outside the key range"
                    : "no goal: the robot " + std::string(describe(corridor));
}

}  // namespace

GoalSelection::State::Member GoalSelection::State::new_member(std::size_t robot) const {
  const TeamMember& member = team[robot];
  try {
    check(member);
    return {TravelCorridor(member.robot.travel, lattice, bounds),
            ViewQualityImage(lattice, member.robot.view, rendering_of(member, robot))};
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("robot '" + member.robot.name + "': " + error.what());
  }
}

GoalSelection::GoalSelection(std::vector<TeamMember> team, const Lattice& lattice, const KeyBox& bounds,
                             bool assign)
    : state_(std::make_unique<State>(State{std::move(team), lattice, bounds, assign})) {
  for (std::size_t r = 0; r < state_->team.size(); ++r) state_->members.push_back(state_->new_member(r));
}
GoalSelection::~GoalSelection() = default;
GoalSelection::GoalSelection(GoalSelection&&) noexcept = default;
GoalSelection& GoalSelection::operator=(GoalSelection&&) noexcept = default;

TeamGoals GoalSelection::select(const RayCaster& caster, const MapChange& change,
                                std::span<const VoxelKey> frontiers, std::span<const Pose> poses,
                                std::optional<std::size_t> choosing) {
  State& state = *state_;
  if (poses.size() != state.team.size())
    refuse(std::to_string(poses.size()) + " poses for " + std::to_string(state.team.size()) + " robots");
  for (std::size_t r = 0; r < poses.size(); ++r)
    if (!poses[r].position.allFinite() || !std::isfinite(poses[r].yaw))
      refuse("the pose of robot '" + state.team[r].robot.name + "' is not finite");
  if (change.grid.resolution() != state.lattice.resolution())
    refuse("the grid has a resolution of " + std::to_string(change.grid.resolution()) +
           " m, the goal selection was made for " + std::to_string(state.lattice.resolution()) + " m");
  State::Keys sorted(frontiers.begin(), frontiers.end());
  detail::sort_once(sorted);

  TeamGoals result;
  result.frontiers = sorted.size();
  result.goals.resize(poses.size());
  state.note_change(change);
  state.begin_step(choosing);
  for (std::size_t r = 0; r < poses.size(); ++r) state.update_corridor(r, change.grid, poses[r]);
  for (std::size_t r = 0; r < poses.size(); ++r)
    if (choosing && *choosing != r)
      result.goals[r] = state.members[r].goal;
    else
      set_no_goal(result.goals[r], state.members[r].corridor.state());
  if (!sorted.empty()) {
    const detail::CountingRayCaster counting(caster, state.lattice);
    State::Step step{counting, change.grid, result, choosing};
    state.assign(step, sorted);
    state.decide(step);
    result.rays = counting.rays();
  }
  for (std::size_t r = 0; r < poses.size(); ++r) state.members[r].goal = result.goals[r];
  return result;
}

void GoalSelection::update_corridor(const MapChange& change, std::size_t robot, const Pose& pose,
                                    CorridorExtent extent) {
  state_->note_change(change);
  state_->update_corridor(robot, change.grid, pose, extent);
}

bool GoalSelection::find_path(std::size_t robot, const VoxelKey& cell,
                              const std::function<bool(const VoxelKey&)>& through) {
  return state_->members[robot].corridor.find_path(cell, through);
}

void GoalSelection::block(std::size_t robot, std::span<const VoxelKey> cells) {
  state_->members[robot].corridor.block(cells);
}

void GoalSelection::lose(std::size_t robot) { state_->lose(robot); }

void GoalSelection::join(std::size_t robot, const TravelOptions& travel) {
  state_->team[robot].robot.travel = travel;
  state_->members[robot] = state_->new_member(robot);
}

void GoalSelection::keep_out_of(std::size_t robot, std::vector<KeyBox> boxes) {
  state_->members[robot].corridor.keep_out_of(std::move(boxes));
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
  // A query needs a caster; rating casts no ray.
  const auto caster = make_grid_ray_caster(VoxelGrid(state_->lattice.resolution()));
  const detail::GoalQuery query = state_->query(*caster, robot, member.targets);
  cells.reserve(member.image.size());
  for (std::size_t i = 0; i < member.image.size(); ++i) cells.push_back(detail::rate(query, member.image, i));
  std::sort(cells.begin(), cells.end(),
            [](const RenderedCell& a, const RenderedCell& b) { return a.cell < b.cell; });
  return cells;
}

}  // namespace frontlux::planner
