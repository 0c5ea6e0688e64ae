#include "bad_input.hpp"
#include "command.hpp"
#include "commands/commands.hpp"
#include "commands/output_file.hpp"
#include "commands/sensor_model_option.hpp"
#include "terminal.hpp"
#include "text.hpp"

#include <frontlux/file.hpp>
#include <frontlux/io/point_cloud.hpp>
#include <frontlux/io/pose_file.hpp>
#include <frontlux/io/scan_graph.hpp>
#include <frontlux/planner/mapping.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <iostream>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <unordered_set>
#include <vector>

namespace frontlux::app {
namespace {

using io::RecordedScan, planner::Mapping, planner::MappingOptions;

struct Options {
  std::string scans, output, poses;
  double resolution = 0.1;
  planner::SensorModel sensor_model = planner::kOctomapSensorModel;
  std::optional<double> max_range;
  std::optional<Eigen::AlignedBox3d> bounds;
};

// Scans one after the other, so that a folder larger than the memory can be mapped.
struct Recording {
  std::size_t scans = 0;
  std::function<std::string(std::size_t)> name;  // for messages
  std::function<RecordedScan(std::size_t)> scan;
  std::uintmax_t bytes = 0;  // of its files
  std::string warning;       // empty: there is none
};

// Which clouds are not mapped, and which again and again, in words.
std::string differences(const std::filesystem::path& folder, const std::filesystem::path& pose_file,
                        const std::vector<io::RecordedPose>& poses) {
  std::map<std::filesystem::path, int> lines;
  for (const io::RecordedPose& pose : poses) ++lines[(folder / pose.file).lexically_normal()];
  std::size_t without = 0, again = 0;
  std::filesystem::path first_without, first_again;
  const auto note = [](const std::filesystem::path& file, std::size_t& count, std::filesystem::path& first) {
    if (count++ == 0 || file < first) first = file;
  };
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string ending = lower_extension(entry.path());
    const std::filesystem::path file = entry.path().lexically_normal();
    if ((ending == ".pcd" || ending == ".ply") && !lines.contains(file)) note(file, without, first_without);
  }
  for (const auto& [file, count] : lines)
    if (count > 1) note(file, again, first_again);
  std::string what;
  if (without > 0)
    what += "clouds of the folder without a line are left out: " + std::to_string(without) +
            ", the first is " + first_without.filename().string();
  if (again > 0)
    what += (what.empty() ? "" : "; ") + std::string("clouds with several lines are mapped with each: ") +
            std::to_string(again) + ", the first is " + first_again.filename().string();
  return what.empty() ? what : pose_file.string() + ": " + what;
}

std::uintmax_t size_of_file(const std::filesystem::path& file) {
  std::error_code error;  // what is wrong with a file, reading says
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  return error ? 0 : size;
}

// Work follows from the clouds' sizes: a line is few bytes, and each maps a cloud once more.
// @return bytes of all clouds
std::uintmax_t check_lines(const std::filesystem::path& folder, const std::filesystem::path& pose_file,
                           const std::vector<io::RecordedPose>& poses) {
  constexpr int kMostLines = 10;
  std::map<std::filesystem::path, int> lines;
  std::uintmax_t bytes = 0;
  std::error_code error;
  for (const io::RecordedPose& pose : poses) {
    const std::filesystem::path file = std::filesystem::weakly_canonical(folder / pose.file, error);
    const int count = ++lines[file];
    if (count == 1) bytes += size_of_file(file);
    if (count > kMostLines)
      throw BadInput(pose_file.string() + ": " + quote(pose.file) + " has more than " +
                     std::to_string(kMostLines) + " lines; a cloud is mapped with each, so give it few");
  }
  return bytes;
}

Recording open_folder(const std::filesystem::path& folder, const std::string& given) {
  const std::filesystem::path pose_file = given.empty() ? folder / "poses.csv" : std::filesystem::path(given);
  const auto poses = std::make_shared<std::vector<io::RecordedPose>>(io::read_pose_file(pose_file));
  const std::uintmax_t bytes = check_lines(folder, pose_file, *poses);
  const auto file = [folder, poses](std::size_t i) { return folder / (*poses)[i].file; };
  return {poses->size(), [file](std::size_t i) { return file(i).string(); },
          [file, poses](std::size_t i) {
            return RecordedScan{(*poses)[i].T_world_sensor, io::read_point_cloud(file(i))};
          },
          bytes, differences(folder, pose_file, *poses)};
}

Recording open_graph(const std::filesystem::path& file, const std::string& pose_file) {
  std::error_code error;
  const std::filesystem::path kind = std::filesystem::exists(file, error) ? lower_extension(file) : "";
  if (kind == ".ply" || kind == ".pcd")
    throw BadInput("SCANS: " + file.string() +
                   " is a single cloud; name the folder that holds it, with its pose in a file (--poses)");
  if (kind == ".bt" || kind == ".ot")
    throw BadInput("SCANS: " + file.string() + " is a map; name a scan graph or a folder of clouds");
  if (!pose_file.empty()) throw BadInput("--poses: a scan graph has its own poses; leave the option out");
  const auto scans = std::make_shared<std::vector<RecordedScan>>(io::read_scan_graph(file));
  return {scans->size(),
          [file](std::size_t i) { return file.string() + ": scan " + std::to_string(i + 1); },
          [scans](std::size_t i) { return (*scans)[i]; },
          size_of_file(file),
          {}};
}

struct Points {
  std::uint64_t all = 0, not_finite = 0;
  std::uint64_t outside = 0;  // the key range
  std::uint64_t beyond = 0;   // the range
};

// What is known grows with the length of the rays: clouds in millimetres would fill all memory.
void check_lengths(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& origin,
                   const std::string& name, double resolution) {
  constexpr double kLongest = 5000.0;  // [voxels]
  for (const Eigen::Vector3f& point : points)
    if (const double length = (point - origin).norm();
        length > kLongest * resolution && std::isfinite(length))
      throw BadInput(name + ": a point is " + to_text(std::round(length)) + " m from the sensor, more than " +
                     to_text(kLongest) +
                     " voxels; check its unit, or give --max-range, or a coarser --resolution");
}

// How far the rays of all scans spread out. Isolated voxels take some 280 bytes, so that few rays that go far
// apart take memory that does not follow from the files' size.
class Spread {
 public:
  /// @param bytes  of all files
  Spread(const Mapping& mapping, std::uintmax_t bytes)
      : mapping_(mapping), most_(std::max(kFew, kForEachPoint * (bytes / kPointBytes))) {}

  void check(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& origin,
             const std::string& name) {
    points_ += points.size();
    for (const Eigen::Vector3f& point : points) {
      if (mapping_.grid().lattice().key(point)) add_ray(origin, point);
      if (cubes_.size() > most_)
        throw BadInput(name + ": up to here " + std::to_string(points_) +
                       " rays spread out too far for their number, and the map would take much memory; give "
                       "--max-range, --bounds, or a coarser --resolution");
    }
  }

 private:
  void add_ray(const Eigen::Vector3f& origin, const Eigen::Vector3f& point) {
    constexpr int kEdge = 8;  // [voxels]
    const Lattice& lattice = mapping_.grid().lattice();
    const Eigen::Vector3f ray = point - origin;
    const int steps = static_cast<int>(static_cast<double>(ray.norm()) / (kEdge / 2 * lattice.resolution()));
    for (int i = 0; i <= steps; ++i) {
      const Eigen::Vector3f at = origin + ray * (static_cast<float>(i) / static_cast<float>(steps + 1));
      if (const auto key = lattice.key(at); key && mapping_.bounds().contains(*key))
        cubes_.insert((key->x / kEdge * 0x1'0000ULL + key->y / kEdge) * 0x1'0000ULL + key->z / kEdge);
    }
  }

  static constexpr std::uintmax_t kFew = 200'000, kForEachPoint = 20;  // cubes: 0.9 GB, 0.1 MB
  static constexpr std::uintmax_t kPointBytes = 12;                    // three numbers as clouds have them

  const Mapping& mapping_;
  std::uintmax_t most_;
  std::size_t points_ = 0;
  std::unordered_set<std::uint64_t> cubes_;  // that rays go through
};

Points map_scans(const Recording& recording, const Options& options, Mapping& mapping) {
  const double max_range = options.max_range.value_or(std::numeric_limits<double>::infinity());
  const ProgressLine progress;
  Points points;
  Spread spread(mapping, recording.bytes);
  for (std::size_t i = 0; i < recording.scans; ++i) {
    progress.show("scan " + std::to_string(i + 1) + " of " + std::to_string(recording.scans));
    const RecordedScan scan = recording.scan(i);
    const Eigen::Vector3f origin = scan.T_world_sensor.translation().cast<float>();
    if (!mapping.grid().lattice().key(origin))
      throw BadInput(recording.name(i) +
                     ": its pose lies outside the map's key range; check it, or give a coarser --resolution");
    const std::vector<Eigen::Vector3f> in_world = io::points_in_world(scan);
    if (!options.max_range) {
      check_lengths(in_world, origin, recording.name(i), mapping.grid().resolution());
      spread.check(in_world, origin, recording.name(i));
    }
    mapping.insert(origin, in_world, max_range);
    points.all += in_world.size();
    for (const Eigen::Vector3f& point : in_world)
      if (!point.allFinite())
        ++points.not_finite;
      else if (!mapping.grid().lattice().key(point))
        ++points.outside;
      else if (static_cast<double>((point - origin).norm()) > max_range)
        ++points.beyond;
  }
  return points;
}

MappingOptions mapping_options(const Options& options) {
  MappingOptions mapping;
  mapping.resolution = options.resolution;
  mapping.sensor_model = options.sensor_model;
  try {
    if (options.bounds) mapping.bounds = planner::voxels_of(Lattice(options.resolution), *options.bounds);
  } catch (const std::invalid_argument& error) {
    throw BadInput(std::string("--bounds: ") + error.what());
  }
  return mapping;
}

void map(const Options& options) {
  Mapping mapping(mapping_options(options));
  check_output(options.output, {".bt", ".ot"}, std::array{options.scans, options.poses});
  std::error_code ignored;  // what is wrong with it, reading says
  const Recording recording = std::filesystem::is_directory(options.scans, ignored)
                                  ? open_folder(options.scans, options.poses)
                                  : open_graph(options.scans, options.poses);
  const Points points = map_scans(recording, options, mapping);
  const auto voxels = mapping.grid().count();
  if (voxels[1] + voxels[2] == 0)
    throw BadInput(options.scans + ": its " + std::to_string(points.all) + " points make no voxel " +
                   (options.bounds ? "within the bounds known; give other --bounds"
                                   : "known; they have to be there, in metres, and within " +
                                         to_text(Lattice::kOrigin * options.resolution) +
                                         " m of the origin along each axis"));
  mapping.write(options.output);
  if (!recording.warning.empty()) warn(recording.warning);
  std::string left_out;
  if (points.beyond > 0)
    left_out += row("beyond", std::to_string(points.beyond) + " of them beyond " +
                                  to_text(*options.max_range) + " m, which only free the space up to it");
  if (points.outside > 0)
    left_out +=
        row("left out", std::to_string(points.outside) + " of them, which lie beyond the map's key range");
  if (points.not_finite > 0)
    left_out += row("left out", std::to_string(points.not_finite) + " of them, which are not finite");
  std::cout << row("map", options.output) << row("resolution", to_text(mapping.grid().resolution()) + " m")
            << row("scans", std::to_string(recording.scans)) << row("points", std::to_string(points.all))
            << left_out << row("free", std::to_string(voxels[1]) + " voxels")
            << row("occupied", std::to_string(voxels[2]) + " voxels");
}

}  // namespace

void add_map_command(CLI::App& app) {
  Command command(app, "map", "Map recorded scans");
  const auto options = std::make_shared<Options>();
  command.add("SCANS", options->scans, "", "OctoMap scan graph (.graph), or a folder of .pcd or .ply clouds")
      .required();
  command.add("-o,--output", options->output, "FILE", "Map to write, .bt or .ot").required();
  command.add("--poses", options->poses, "FILE", "Poses of a folder's clouds [poses.csv in the folder]");
  command.add("--resolution", options->resolution, "METRES", "Edge length of a voxel", kVoxelEdges);
  command.add("--max-range", options->max_range, "METRES",
              "Longest range of a hit; farther points only free the space up to it [no limit; "
              "points farther than 5,000 voxels are refused then]",
              kAboveZero);
  command.add("--bounds", options->bounds, "X,Y,Z,X,Y,Z",
              "Box to map: lowest and highest corner [everything]");
  add_sensor_model_option(command, options->sensor_model);
  command.examples(R"(Examples:
  frontlux map corridor.graph -o corridor.bt --resolution 0.05
  frontlux map clouds/ -o clouds.ot --max-range 20 --bounds -10,-10,0,10,10,4
Clouds are in the sensor's frame. The pose file has a line for each cloud, in metres and radians:
file,x,y,z,qx,qy,qz,qw or file,x,y,z,yaw.)");
  command.run([options] {
    work_on(options->scans, "give --max-range, --bounds or a coarser --resolution", [&] { map(*options); });
  });
}

}  // namespace frontlux::app
