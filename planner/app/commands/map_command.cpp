#include "commands/map_command.hpp"

#include "bad_input.hpp"
#include "map_output.hpp"
#include "progress_line.hpp"
#include "text.hpp"

#include <frontlux/planner/mapping.hpp>
#include <frontlux/io/point_cloud.hpp>
#include <frontlux/io/pose_file.hpp>
#include <frontlux/io/scan_graph.hpp>

#include <CLI/CLI.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace frontlux::app {
namespace {

using planner::Mapping;
using planner::MappingOptions;
using io::RecordedScan;

struct Options {
  std::string scans, output, poses;
  std::string resolution = "0.1", max_range, bounds;  // as written; empty if not given
};

// Scans one after the other, so that a folder larger than the memory can be mapped.
struct Recording {
  std::size_t scans = 0;
  std::function<std::string(std::size_t)> name;  // for messages
  std::function<RecordedScan(std::size_t)> scan;
};

Recording open_folder(const std::filesystem::path& folder, const std::string& pose_file) {
  const auto poses = std::make_shared<std::vector<io::RecordedPose>>(
      io::read_pose_file(pose_file.empty() ? folder / "poses.csv" : std::filesystem::path(pose_file)));
  const auto file = [folder, poses](std::size_t i) { return folder / (*poses)[i].file; };
  return {poses->size(), [file](std::size_t i) { return file(i).string(); },
          [file, poses](std::size_t i) {
            return RecordedScan{(*poses)[i].T_world_sensor, io::read_point_cloud(file(i))};
          }};
}

Recording open_graph(const std::filesystem::path& file, const std::string& pose_file) {
  if (!pose_file.empty()) throw BadInput("--poses: a scan graph has its own poses; leave the option out");
  const auto scans = std::make_shared<std::vector<RecordedScan>>(io::read_scan_graph(file));
  return {scans->size(), [file](std::size_t i) { return file.string() + ": scan " + std::to_string(i + 1); },
          [scans](std::size_t i) { return (*scans)[i]; }};
}

KeyBox parse_bounds(const Lattice& lattice, std::string_view text) {
  std::vector<double> numbers;
  for (std::string_view rest = text;; rest.remove_prefix(rest.find(',') + 1)) {
    numbers.push_back(parse_number("--bounds", rest.substr(0, rest.find(','))));
    if (rest.find(',') == std::string_view::npos) break;
  }
  if (numbers.size() != 6)
    throw BadInput(
        "--bounds: '" + std::string(text) +
        "' is not six numbers; give the lowest and the highest corner, as in --bounds=-5,-5,0,5,5,3");
  const Eigen::AlignedBox3d box(Eigen::Vector3d(numbers[0], numbers[1], numbers[2]),
                                Eigen::Vector3d(numbers[3], numbers[4], numbers[5]));
  try {
    return planner::voxels_of(lattice, box);
  } catch (const std::invalid_argument& error) {
    throw BadInput(std::string("--bounds: ") + error.what());
  }
}

MappingOptions mapping_options(const Options& options) {
  MappingOptions mapping;
  mapping.resolution = parse_resolution(options.resolution);
  if (!options.bounds.empty()) mapping.bounds = parse_bounds(Lattice(mapping.resolution), options.bounds);
  return mapping;
}

std::uint64_t map_scans(const Recording& recording, double max_range, Mapping& mapping) {
  const ProgressLine progress;
  std::uint64_t points = 0;
  for (std::size_t i = 0; i < recording.scans; ++i) {
    progress.show("scan " + std::to_string(i + 1) + " of " + std::to_string(recording.scans));
    const RecordedScan scan = recording.scan(i);
    const Eigen::Vector3f origin = scan.T_world_sensor.translation().cast<float>();
    if (!mapping.grid().lattice().key(origin))
      throw BadInput(recording.name(i) +
                     ": its pose lies outside the map's key range; check it, or give a coarser --resolution");
    mapping.insert(origin, io::points_in_world(scan), max_range);
    points += scan.points.size();
  }
  return points;
}

void map(const Options& options) {
  const MappingOptions mapping_with = mapping_options(options);
  const double max_range = options.max_range.empty() ? std::numeric_limits<double>::infinity()
                                                     : parse_length("--max-range", options.max_range);
  check_map_output(options.output);
  try {
    const Recording recording = std::filesystem::is_directory(options.scans)
                                    ? open_folder(options.scans, options.poses)
                                    : open_graph(options.scans, options.poses);
    Mapping mapping(mapping_with);
    const std::uint64_t points = map_scans(recording, max_range, mapping);
    const auto voxels = mapping.grid().count();
    if (voxels[1] + voxels[2] == 0)
      throw BadInput(options.scans + ": none of its " + std::to_string(points) +
                     " points tells anything within the bounds");
    mapping.write(options.output);
    std::cout << row("map", options.output) << row("resolution", to_text(mapping.grid().resolution()) + " m")
              << row("scans", std::to_string(recording.scans)) << row("points", std::to_string(points))
              << row("free", std::to_string(voxels[1]) + " voxels")
              << row("occupied", std::to_string(voxels[2]) + " voxels");
  } catch (const BadInput&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw BadInput(error.what());
  } catch (const std::bad_alloc&) {
    throw BadInput(options.scans +
                   ": its map does not fit into this machine's memory; give --max-range, --bounds or a "
                   "coarser --resolution");
  }
}

}  // namespace

void add_map_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("map", "Map recorded scans");
  const auto options = std::make_shared<Options>();
  command
      ->add_option("SCANS", options->scans, "OctoMap scan graph (.graph), or a folder of .pcd or .ply clouds")
      ->required();
  command->add_option("-o,--output", options->output, "Map to write, .bt or .ot")
      ->required()
      ->type_name("FILE");
  command->add_option("--poses", options->poses, "Poses of a folder's clouds (default: poses.csv in it)")
      ->type_name("FILE");
  command->add_option("--resolution", options->resolution, "Edge of a voxel [m]")
      ->type_name("M")
      ->capture_default_str();
  command->add_option("--max-range", options->max_range, "Beyond it points clear the way and are no hits [m]")
      ->type_name("M");
  command->add_option("--bounds", options->bounds, "Box outside of which nothing is mapped [m]")
      ->type_name("X,Y,Z,X,Y,Z");
  command->footer(
      "Examples:\n"
      "  frontlux map corridor.graph -o corridor.bt --resolution 0.05\n"
      "  frontlux map clouds/ -o clouds.ot --max-range 20 --bounds -10,-10,0,10,10,4\n"
      "The clouds are in the sensor's frame. A line of the pose file says where one was recorded, in metres "
      "and\n"
      "radians: file,x,y,z,qx,qy,qz,qw or file,x,y,z,yaw.");
  command->callback([options] { map(*options); });
}

}  // namespace frontlux::app
