// How wide a door has to be, by the robot and the voxels, wherever the lattice lies: the table in
// docs/robots.md, "Which voxels for which door".

#include "planner/corridor/robots_page.hpp"
#include "sim/mesh/box_mesh.hpp"
#include "support/voxel_keys.hpp"

#include <frontlux/planner/robot.hpp>
#include <frontlux/sim/ground_truth.hpp>

#include <iomanip>

namespace frontlux::planner {
namespace {

constexpr int kOffsets = 20;                                // of the door, in parts of a voxel
constexpr int kPerMetre = 20;                               // widths of doors that are tried
constexpr std::array kResolutions = {0.3, 0.2, 0.15, 0.1};  // [m]

// Two rooms with a wall of 0.2 m between them, in it a door: what can be seen of them is known.
struct Doorway {
  VoxelGrid grid;
  KeyBox bounds;

  Doorway(double resolution, double width, double offset) : grid(resolution) {
    const auto at = static_cast<float>(offset), side = static_cast<float>(offset + width);
    sim::World world;
    const auto block = [&](const Eigen::Vector3f& low, const Eigen::Vector3f& high) {
      sim::test::add_box(world.mesh, {low, high});
    };
    block({-5.0F, -5.0F, -1.0F}, {5.0F, 5.0F, 0.0F});
    block({at, -5.0F, 0.0F}, {at + 0.2F, at, 3.0F});
    block({at, side, 0.0F}, {at + 0.2F, 5.0F, 3.0F});
    world.bounds = {Eigen::Vector3d(-1.8, width / 2 - 1.05, -0.1),
                    Eigen::Vector3d(2.2, width / 2 + 1.05, 1.05)};
    const sim::GroundTruth truth(world, resolution, {-1.0, width / 2, 0.05});
    bounds = truth.bounds();
    for_each_key(bounds, [&](const VoxelKey& key) {
      const sim::Truth state = truth.at(key);
      if (state != sim::Truth::kHidden)
        grid.set(key, state == sim::Truth::kFree ? Occupancy::kFree : Occupancy::kOccupied);
    });
  }

  [[nodiscard]] bool lets_through(const TravelOptions& travel, double width) const {
    const double height = travel.drives() ? travel.sensor_height : 0.47;
    const auto cell = [&](double x) {
      return grid.lattice().key(Eigen::Vector3d(x, width / 2, height)).value();
    };
    TravelCorridor corridor(travel, grid.lattice(), bounds);
    corridor.update({grid}, cell(-0.9));
    EXPECT_EQ(corridor.state(), CorridorState::kReady) << describe(corridor.state());
    return corridor.contains(cell(1.4));
  }
};

// A robot as it is in voxels of a size; doors are passed along x.
struct Body {
  std::string name;
  std::function<TravelOptions(double resolution)> travel;
};

TravelOptions cylinder(double margin) {
  TravelOptions travel;
  travel.shape = BodyShape::kCylinder;
  travel.extents = {0.5, 0.5, 0.3};
  travel.margin = margin;
  travel.min_height = 0.15;
  return travel;
}

// On the ground where voxels tell steps from floor.
TravelOptions rover(double resolution, double along, double across) {
  TravelOptions travel;
  travel.extents = {along, across, 0.5};
  travel.margin = 0.05;
  travel.ground_extents = Eigen::Vector2d(0.4, 0.4);
  travel.motion = resolution <= travel.step ? Motion::kGround : Motion::kPlane;
  return travel;
}

const std::vector<Body>& bodies() {
  static const std::vector<Body> all = {
      {"UAV of `--team`, 0.8 m", [](double edge) { return in_motion(uav(), edge).travel; }},
      {"UGV of `--team`, 1.0 m", [](double edge) { return in_motion(ugv(), edge).travel; }},
      {"cylinder of 0.5 m", [](double) { return cylinder(0.0); }},
      {"cylinder of 0.5 m, margin 0.05 m", [](double) { return cylinder(0.05); }},
      {"box, 0.5 m across the door, margin 0.05 m", [](double edge) { return rover(edge, 0.67, 0.5); }},
      {"box, 0.67 m across the door, margin 0.05 m", [](double edge) { return rover(edge, 0.5, 0.67); }}};
  return all;
}

// Voxels of its box across a door: the smallest odd number that covers body and margin.
int voxels_across(const TravelOptions& travel, double resolution) {
  int voxels = 1;
  while (voxels * resolution < travel.extents.y() + 2 * travel.margin - 1e-9) voxels += 2;
  return voxels;
}

// At how many offsets doors let a robot through, by their width in parts of a metre.
using Passes = std::map<int, int>;

// By robot; of each from doors that should be a little too narrow to those that let it through wherever the
// lattice lies.
std::vector<Passes> passes_at(double resolution) {
  std::vector<Passes> passes(bodies().size());
  for (int width = 8; width <= 2 * kPerMetre; ++width) {
    const double metres = static_cast<double>(width) / kPerMetre;
    std::vector<std::size_t> open;
    for (std::size_t b = 0; b < bodies().size(); ++b) {
      const TravelOptions travel = bodies()[b].travel(resolution);
      const bool done = !passes[b].empty() && passes[b].rbegin()->second == kOffsets;
      if (!done && metres > voxels_across(travel, resolution) * resolution - 0.11) open.push_back(b);
    }
    for (int i = 0; i < kOffsets && !open.empty(); ++i) {
      const Doorway door(resolution, metres, resolution * i / kOffsets);
      for (const std::size_t b : open)
        passes[b][width] += door.lets_through(bodies()[b].travel(resolution), metres) ? 1 : 0;
    }
  }
  return passes;
}

int narrowest(const Passes& passes, int count) {
  const auto found = std::ranges::find_if(passes, [&](const auto& of) { return of.second >= count; });
  return found == passes.end() ? 0 : found->first;
}

TEST(DoorWidth, IsWhatThePageSays) {
  std::vector<std::ostringstream> rows(bodies().size());
  for (std::size_t b = 0; b < rows.size(); ++b) rows[b] << "| " << bodies()[b].name << " |";
  for (const double resolution : kResolutions) {
    const std::vector<Passes> passes = passes_at(resolution);
    for (std::size_t b = 0; b < rows.size(); ++b) {
      SCOPED_TRACE(bodies()[b].name + ", voxels of " + std::to_string(resolution));
      const TravelOptions travel = bodies()[b].travel(resolution);
      const double needed = voxels_across(travel, resolution) * resolution;
      // As many voxels as the box has are free somewhere in a door that is as wide; wherever the lattice lies
      // in one that is wider by a voxel. Between the two the lattice decides.
      for (const auto& [width, count] : passes[b]) {
        const double beyond = (static_cast<double>(width) / kPerMetre - needed) / resolution;
        EXPECT_NEAR(static_cast<double>(count) / kOffsets, std::clamp(beyond, 0.0, 1.0), 1.01 / kOffsets)
            << "door of " << width << " / " << kPerMetre << " m";
      }
      const double always = static_cast<double>(narrowest(passes[b], kOffsets)) / kPerMetre,
                   at_best = static_cast<double>(narrowest(passes[b], 1)) / kPerMetre;
      EXPECT_NEAR(always, needed + resolution, 1e-9);
      EXPECT_NEAR(at_best, needed, 1e-9);
      EXPECT_LE(always, travel.extents.y() + 2 * travel.margin + 3 * resolution + 1e-9);
      rows[b] << std::fixed << std::setprecision(2) << " " << always << " (" << at_best << ") |";
    }
  }
  for (const std::ostringstream& row : rows) test::expect_row_in_robots_page(row.str());
}

}  // namespace
}  // namespace frontlux::planner
