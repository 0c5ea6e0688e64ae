#include "report/explored_run.hpp"

#include "planner/exploration/team_in_world.hpp"

namespace frontlux::test {
namespace {

// Counts what each robot makes known first.
class Knowledge {
 public:
  Knowledge(const sim::GroundTruth& truth, std::size_t robots) : truth_(truth), known_(robots) {}

  const std::vector<planner::KnownVoxels>& after(const planner::ExplorationStep& step) {
    for (std::size_t r = 0; r < step.robots.size(); ++r)
      for (const planner::VoxelChange& change : step.robots[r].changed) {
        if (change.before != Occupancy::kUnknown || !seen_.insert(change.key).second) continue;
        ++known_[r].bounding;
        if (truth_.contains(change.key)) ++known_[r].observable;
      }
    return known_;
  }

 private:
  const sim::GroundTruth& truth_;
  std::set<VoxelKey> seen_;
  std::vector<planner::KnownVoxels> known_;
};

}  // namespace

planner::Recording explored_run(const std::string& world_name, int steps, bool uav_alone) {
  std::vector<planner::RobotDescription> robots = uav_and_ugv();
  if (uav_alone) robots.erase(robots.begin());
  const TeamInWorld team(world_name, 1, std::move(robots));
  planner::Recording recording;
  recording.head = {.world = world_name,
                    .resolution = 0.3,
                    .bounds = team.truth.bounds(),
                    .robots = team.robots,
                    .starts = team.starts,
                    .observable = team.truth.observable_voxels(),
                    .bounding = team.truth.bounding_voxels(),
                    .options = R"({"seed": 1, "mode": "default", "path": {"spacing_m": 1.2}})"};
  Knowledge knowledge(team.truth, team.robots.size());
  sim::SimulatedRobots simulated = team.bodies();
  std::uint64_t contacts = 0;
  const auto record = [&](ExplorationStep step) {
    const auto& known = knowledge.after(step);
    recording.steps.push_back({std::move(step), known, simulated.contacts() - contacts});
    contacts = simulated.contacts();
  };
  const planner::Drive drive = drive_by(simulated);
  Exploration exploration(team.options(), team.empty_map());
  record(exploration.begin(team.starts, drive));
  while (!exploration.end() && std::cmp_less(recording.steps.size(), steps)) record(exploration.step(drive));
  recording.end = exploration.end() ? name_of(*exploration.end()) : "stopped";
  return recording;
}

}  // namespace frontlux::test
