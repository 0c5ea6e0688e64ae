#include "commands/cast_command.hpp"

#include "bad_input.hpp"
#include "caster_option.hpp"
#include "json.hpp"
#include "map_file.hpp"
#include "text.hpp"

#include <CLI/CLI.hpp>

#include <array>
#include <cstdint>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace frontlux::app {
namespace {

struct Options {
  std::string map;
  std::string from, to, direction, range;  // as written; empty if not given
  std::string unknown = "block";
  CasterKind caster = CasterKind::kFast;
  bool count = false, json = false;
};

struct Answer {
  Hit hit;
  std::optional<bool> visible;               // of the voxel of --to
  std::optional<PathCount> crossed, before;  // on the way to the hit, and to --to
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

Answer cast(const Options& options) {
  if (options.to.empty() == options.direction.empty())
    throw BadInput(options.to.empty() ? "cast needs --to or --direction; see frontlux cast --help"
                                      : "cast takes --to or --direction, not both; leave one out");
  Ray ray;
  ray.origin = parse_vector("--from", options.from);
  std::optional<Eigen::Vector3f> to;
  if (!options.to.empty()) {
    to = parse_vector("--to", options.to);
    ray.direction = *to - ray.origin;
  } else {
    ray.direction = parse_vector("--direction", options.direction);
    if (ray.direction.isZero(0.F))
      throw BadInput("--direction: " + options.direction + " has no length; give at least one number but 0");
  }
  if (!options.range.empty()) {
    ray.max_range = parse_number("--range", options.range);
    if (ray.max_range <= 0.)
      throw BadInput("--range: " + options.range + " m is no range; give one above 0, or none for no limit");
  }
  const UnknownPolicy unknown = options.unknown == "pass" ? UnknownPolicy::kPass : UnknownPolicy::kBlock;

  const MapFile map = read_map_file(options.map);
  const Lattice lattice(map.resolution);
  check_inside(lattice, "--from", ray.origin);
  if (to) check_inside(lattice, "--to", *to);
  if (to && *to == ray.origin)
    throw BadInput("--to: " + options.to + " is the point of --from; give another, or a --direction");

  const auto caster = std::visit(
      [&](const auto& tree) { return make_ray_caster(options.caster, make_voxel_grid(map), *tree); },
      map.tree);
  Answer answer{caster->cast(ray, unknown), {}, {}, {}};
  if (answer.hit.stop == RayStop::kInvalid)
    throw BadInput((to ? "--to: " + options.to : "--direction: " + options.direction) +
                   " gives no direction that a float can hold; give one of a length nearer to 1");
  if (options.count) caster->count({&ray, 1}, {&answer.crossed.emplace(), 1}, unknown);
  if (to) {
    const Segment segment{ray.origin, *to};
    if (options.count) caster->count({&segment, 1}, {&answer.before.emplace(), 1}, unknown);
    std::uint8_t visible = 0;
    caster->visible({&segment, 1}, {&visible, 1}, unknown);
    answer.visible = visible != 0;
  }
  return answer;
}

std::string explain(RayStop stop) {
  switch (stop) {
    case RayStop::kOccupied:
      return "hit an occupied voxel";
    case RayStop::kUnknown:
      return "stopped by an unknown voxel";
    case RayStop::kOutOfRange:
      return "nothing within --range; this is the first voxel beyond it";
    case RayStop::kLeftMap:
      return "nothing up to the end of the map's key range; this is the last voxel";
    case RayStop::kReached:
    case RayStop::kInvalid:
      break;
  }
  return "no ray";
}

std::string list(const PathCount& count) {
  return std::to_string(count.unknown) + " unknown, " + std::to_string(count.free) + " free, " +
         std::to_string(count.occupied) + " occupied voxels";
}

std::string name_of(RayStop stop) {
  constexpr std::array kNames = {"invalid", "occupied", "unknown", "out_of_range", "left_map", "reached"};
  return kNames[static_cast<std::size_t>(stop)];
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
  if (answer.before)
    out += row("on the way", list(*answer.before) + (answer.before->stop == RayStop::kReached
                                                         ? " (before that of --to)"
                                                         : " (before the way to that of --to ends)"));
  std::cout << out;
}

void print_json(const Answer& answer) {
  const Hit& hit = answer.hit;
  JsonObject out;
  out.add("hit", hit.occupied())
      .add("stop", name_of(hit.stop))
      .add("key", hit.key)
      .add("state", to_text(hit.state))
      .add("end_m", hit.end)
      .add("entry_m", hit.entry)
      .add("distance_m", hit.distance);
  const auto add = [&](const char* name, const PathCount& count) {
    out.add(name, JsonObject()
                      .add("unknown", std::uint64_t{count.unknown})
                      .add("free", std::uint64_t{count.free})
                      .add("occupied", std::uint64_t{count.occupied})
                      .add("stop", name_of(count.stop)));
  };
  if (answer.crossed) add("crossed", *answer.crossed);
  if (answer.visible) out.add("visible", *answer.visible);
  if (answer.before) add("before_to", *answer.before);
  std::cout << out.text() << '\n';
}

}  // namespace

void add_cast_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("cast", "Cast one ray into a map and say where it ends");
  const auto options = std::make_shared<Options>();
  command->add_option("MAP", options->map, "OctoMap file, .bt or .ot")->required();
  command->add_option("--from", options->from, "Where the ray starts [m]")->required()->type_name("X,Y,Z");
  command->add_option("--to", options->to, "A point on its way, which it may pass [m]")->type_name("X,Y,Z");
  command->add_option("--direction", options->direction, "Its direction, of any length")->type_name("X,Y,Z");
  command->add_option("--range", options->range, "Limit on the distance to voxel centres [m]")
      ->type_name("M");
  command->add_option("--unknown", options->unknown, "Whether unknown voxels block the ray or let it pass")
      ->check(CLI::IsMember({"block", "pass"}))
      ->capture_default_str();
  add_caster_option(*command, options->caster, "What casts it; all give the same answer");
  command->add_flag("--count", options->count,
                    "Also count the voxels crossed: by the ray, and with --to on the way there");
  command->add_flag("--json", options->json, "Print one JSON object");
  command->footer(
      "Examples:\n"
      "  frontlux cast building.bt --from 0,0,1.2 --direction 1,0,0 --range 10\n"
      "  frontlux cast building.bt --from -2.5,0,1.2 --to 4,-1,0.5 --unknown pass\n"
      "  frontlux cast building.bt --from 0,0,1.2 --direction 1,0,0 --range 10 --unknown pass --count\n"
      "The first asks what a sensor at (0, 0, 1.2) sees along x within 10 m. The second also says whether\n"
      "the voxel that holds (4, -1, 0.5) is visible when unknown voxels do not block the view. The third\n"
      "counts the unknown, free and occupied voxels that the first's ray crosses if unknown voxels let it\n"
      "pass: from its first voxel, included, to the one in which it ended, excluded.");
  command->callback([options] {
    const Answer answer = cast(*options);
    options->json ? print_json(answer) : print_text(answer);
  });
}

}  // namespace frontlux::app
