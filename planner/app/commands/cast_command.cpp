#include "bad_input.hpp"
#include "command.hpp"
#include "commands/commands.hpp"
#include "map_file.hpp"
#include "text.hpp"

#include <frontlux/ray_caster.hpp>

#include <nlohmann/json.hpp>

#include <array>
#include <cstdint>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace frontlux::app {
namespace {

using Json = nlohmann::ordered_json;

struct CastOptions {
  std::string map;
  Eigen::Vector3f from = Eigen::Vector3f::Zero();
  std::optional<Eigen::Vector3f> to, direction;
  std::optional<double> range;
  UnknownPolicy unknown = UnknownPolicy::kBlock;
  CasterKind caster = CasterKind::kFast;
  bool count = false, json = false;
};

struct Answer {
  Hit hit;
  std::optional<bool> visible;                  // of the voxel of --to
  std::optional<PathCount> crossed, before_to;  // up to the hit, and up to --to
};

void check_inside(const Lattice& lattice, std::string_view name, const Eigen::Vector3f& point) {
  constexpr std::array kAxes = {"x", "y", "z"};
  const double edge = Lattice::kOrigin * lattice.resolution();
  for (int i = 0; i < 3; ++i)
    if (!lattice.key(static_cast<double>(point[i])))
      throw BadInput(std::string(name) + ": " + kAxes[static_cast<std::size_t>(i)] + " = " +
                     to_text(point[i]) + " m lies outside the map's key range; give a value from " +
                     rounded(-edge) + " m to below " + rounded(edge) + " m");
}

Answer cast(const CastOptions& options) {
  if (options.direction && options.direction->isZero(0.F))
    throw BadInput("--direction: " + to_text(*options.direction) +
                   " in single precision, which has no length; give a number other than 0");
  if (options.to == options.from)
    throw BadInput("--to: " + to_text(*options.to) +
                   " is the point of --from; give another, or a --direction");
  const Ray ray{options.from, options.to ? Eigen::Vector3f(*options.to - options.from) : *options.direction,
                options.range.value_or(-1.0)};
  const MapFile map = read_map_file(options.map);
  const Lattice lattice(map.resolution);
  check_inside(lattice, "--from", ray.origin);
  if (options.to) check_inside(lattice, "--to", *options.to);

  const auto caster = make_caster(map, make_grid(map), options.caster);
  Answer answer{caster->cast(ray, options.unknown), {}, {}, {}};
  if (answer.hit.stop == RayStop::kInvalid)
    throw BadInput((options.to ? "--to: " : "--direction: ") +
                   to_text(options.to ? *options.to : ray.direction) +
                   " gives no direction that a float can hold; give one of a length nearer to 1");
  if (options.count) caster->count({&ray, 1}, {&answer.crossed.emplace(), 1}, options.unknown);
  if (options.to) {
    const Segment segment{ray.origin, *options.to};
    if (options.count) caster->count({&segment, 1}, {&answer.before_to.emplace(), 1}, options.unknown);
    std::uint8_t visible = 0;
    caster->visible({&segment, 1}, {&visible, 1}, options.unknown);
    answer.visible = visible != 0;
  }
  return answer;
}

std::string explain(RayStop stop) {
  constexpr std::array kTexts = {"no ray", "hit an occupied voxel", "stopped by an unknown voxel",
                                 "nothing hit within --range; this is the first voxel beyond it",
                                 "nothing hit up to the end of the map's key range; this is the last voxel"};
  return kTexts.at(static_cast<std::size_t>(stop));
}

std::string list(const PathCount& count) {
  return std::to_string(count.unknown) + " unknown, " + std::to_string(count.free) + " free, " +
         std::to_string(count.occupied) + " occupied voxels";
}

std::string name_of(RayStop stop) {
  constexpr std::array kNames = {"invalid", "occupied", "unknown", "out_of_range", "left_map", "reached"};
  return kNames[static_cast<std::size_t>(stop)];
}

const char* until(RayStop stop) {
  if (stop == RayStop::kReached) return "";
  return stop == RayStop::kOutOfRange ? " (the path passes beside the voxel of --to)"
                                      : " (up to the voxel that blocks the view)";
}

void print_text(const Answer& answer) {
  const Hit& hit = answer.hit;
  std::string out = row("result", explain(hit.stop)) +
                    row("voxel", "key " + to_text(hit.key) + ", " + to_text(hit.state)) +
                    row("end", to_text(hit.end) + " m (its centre)") +
                    row("entry", to_text(hit.entry) + " m (where the ray enters it)") +
                    row("distance", to_text(hit.distance) + " m (to the entry)");
  if (answer.crossed)
    out += row("crossed", list(*answer.crossed) +
                              (hit.stop == RayStop::kLeftMap ? " (with this one)" : " (before this one)"));
  if (answer.visible)
    out += row("visible", *answer.visible ? "yes, the voxel of --to is" : "no, the voxel of --to is not");
  if (answer.before_to) out += row("before --to", list(*answer.before_to) + until(answer.before_to->stop));
  std::cout << out;
}

Json json_of(const VoxelKey& key) { return {key.x, key.y, key.z}; }
Json json_of_point(const Eigen::Vector3f& point) {
  return {as_written(point.x()), as_written(point.y()), as_written(point.z())};
}
Json json_of(const PathCount& count) {
  return {{"unknown", count.unknown},
          {"free", count.free},
          {"occupied", count.occupied},
          {"stop", name_of(count.stop)}};
}

void print_json(const Answer& answer) {
  const Hit& hit = answer.hit;
  Json out = {{"hit", hit.occupied()},
              {"stop", name_of(hit.stop)},
              {"key", json_of(hit.key)},
              {"state", to_text(hit.state)},
              {"end_m", json_of_point(hit.end)},
              {"entry_m", json_of_point(hit.entry)},
              {"distance_m", as_written(hit.distance)}};
  if (answer.crossed) out["crossed"] = json_of(*answer.crossed);
  if (answer.visible) out["visible"] = *answer.visible;
  if (answer.before_to) out["before_to"] = json_of(*answer.before_to);
  std::cout << out.dump() << '\n';
}

}  // namespace

void add_cast_command(CLI::App& app) {
  Command command(app, "cast", "Cast one ray into a map and print where it ends");
  const auto options = std::make_shared<CastOptions>();
  command.add("MAP", options->map, "", "OctoMap file, .bt or .ot").required();
  command.group("Ray");
  command.add("--from", options->from, "X,Y,Z", "Origin").required();
  Option to = command.add("--to", options->to, "X,Y,Z", "A point to aim at; the ray may pass it");
  Option direction =
      command.add("--direction", options->direction, "X,Y,Z", "Direction, of any length that a float has");
  command.require_one(to, direction);
  command.add("--range", options->range, "METRES", "Longest distance to a voxel's centre [no limit]",
              kAboveZero);
  command.add("--unknown", options->unknown, "Unknown voxels block the ray or let it pass");
  command.group("Method and output");
  command.add("--caster", options->caster,
              "Ray caster; the first three give the same answer, octomap may call other voxels\nvisible");
  command.add_flag("--count", options->count, "Count the voxels crossed: by the ray, and before --to");
  command.add_flag("--json", options->json, "Print one JSON object");
  command.examples(R"(Examples:
  frontlux cast building.bt --from 0,0,1.2 --direction 1,0,0 --range 10
  frontlux cast building.bt --from -2.5,0,1.2 --to 4,-1,0.5 --unknown pass
  frontlux cast building.bt --from 0,0,1.2 --direction 1,0,0 --range 10 --unknown pass --count
The first prints what a sensor at (0, 0, 1.2) sees along x within 10 m. The second also prints whether
the voxel of (4, -1, 0.5) is visible when unknown voxels do not block the view. The third also counts
the unknown, free and occupied voxels that the ray crosses, from its first voxel, included, to its
last, excluded.)");
  command.run([options] {
    const Answer answer = cast(*options);
    options->json ? print_json(answer) : print_text(answer);
  });
}

}  // namespace frontlux::app
