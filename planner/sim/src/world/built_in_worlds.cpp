#include "world/building.hpp"

#include <frontlux/sim/built_in_worlds.hpp>

#include <array>
#include <stdexcept>
#include <string>

namespace frontlux::sim {
namespace {

constexpr std::array kWorlds = {
    BuiltInWorld{"maze", "40 x 40 x 3 m: corridors, low tunnels for the UGV, low walls for the UAV"},
    BuiltInWorld{"factory",
                 "45 x 30 x 9 m: machines, tanks, conveyor, shelves, mezzanine, ducts, side rooms"},
    BuiltInWorld{"station", "80 x 40 x 12 m: concourse, two platforms, trains, mezzanine, kiosks, trusses"},
    BuiltInWorld{"storage", "25 x 15 x 6 m: rows of racks with goods, an office in a corner"},
    BuiltInWorld{"room", "12 x 12 x 3 m: a partition, a pillar and some furniture, for tests"},
};
constexpr std::array kBuilders = {build_maze, build_factory, build_station, build_storage, build_room};
static_assert(kWorlds.size() == kBuilders.size());

// A mirrored floor plan is another one to a robot.
void mirror(Building& building, std::uint64_t seed) {
  LayoutRandom random(seed, 1);
  const bool x = random.chance(50), y = random.chance(50);
  building.solid.mirror(building.inside, x, y);
  const auto mirrored = [](int place, const Span& frame) { return Span{place, place}.mirrored(frame).from; };
  if (x) building.start.x() = mirrored(building.start.x(), building.inside.x);
  if (y) building.start.y() = mirrored(building.start.y(), building.inside.y);
}

}  // namespace

std::span<const BuiltInWorld> built_in_worlds() { return kWorlds; }

World make_world(std::string_view name, std::uint64_t seed) {
  std::string names;
  for (std::size_t i = 0; i < kWorlds.size(); ++i) {
    if (kWorlds[i].name != name) {
      names.append(names.empty() ? "" : ", ").append(kWorlds[i].name);
      continue;
    }
    Building building = kBuilders[i](seed);
    mirror(building, seed);
    World world;
    world.name = name;
    world.mesh = building.solid.surface();
    world.bounds = bounds_of(world.mesh);
    world.start = metres(building.start);
    return world;
  }
  throw std::invalid_argument("make_world: there is no world '" + std::string(name) + "', only " + names);
}

}  // namespace frontlux::sim
