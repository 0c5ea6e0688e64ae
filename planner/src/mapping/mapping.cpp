#include "mapping/scan_tree.hpp"
#include "mapping/scan_voxels.hpp"

#include <frontlux/file.hpp>
#include <frontlux/octomap.hpp>
#include <frontlux/planner/mapping.hpp>
#include <frontlux/stopwatch.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

namespace frontlux::planner {
namespace {

void check(const SensorModel& sensor) {
  const auto& [hit, miss, least, most] = sensor;
  if (0.0 < least && least < miss && miss < 0.5 && 0.5 < hit && hit < most && most < 1.0) return;
  throw std::invalid_argument("the sensor model has hit " + std::to_string(hit) + ", miss " +
                              std::to_string(miss) + ", least " + std::to_string(least) + " and most " +
                              std::to_string(most) +
                              ", but 0 < least < miss < 0.5 < hit < most < 1 has to hold");
}

void check(const MappingOptions& options) {
  if (!(std::isfinite(options.surface_depth) && options.surface_depth >= 0.0))
    throw std::invalid_argument("surface_depth is " + std::to_string(options.surface_depth) +
                                " m, but has to be finite and not negative");
  if (!options.bounds.contains(options.bounds.min) || !options.bounds.contains(options.bounds.max))
    throw std::invalid_argument(
        "the bounds of the map hold no voxel: their lowest key lies above their highest");
  check(options.sensor_model);
  static_cast<void>(Lattice(options.resolution));  // refuses what is no length before OctoMap sees it
}

}  // namespace

void check(const Scan& scan) {
  const auto refuse = [](const std::string& what) { throw std::invalid_argument("scan: " + what); };
  if (scan.directions.size() != scan.ranges.size())
    refuse(std::to_string(scan.directions.size()) + " directions, but " + std::to_string(scan.ranges.size()) +
           " ranges");
  if (!scan.origin.allFinite()) refuse("its origin is not finite");
  if (!(scan.max_range > 0.0 && std::isfinite(scan.max_range)))
    refuse("max_range is " + std::to_string(scan.max_range) + " m, but has to be positive");
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    if (!(std::fabs(scan.directions[i].norm() - 1.0F) < 1e-3F))
      refuse("direction " + std::to_string(i) + " is not of unit length");
    const auto range = static_cast<double>(scan.ranges[i]);
    if (range < 0.0 || (std::isfinite(range) && range > scan.max_range * (1.0 + 1e-6)))
      refuse("range " + std::to_string(i) + " is " + std::to_string(range) + " m, outside 0 to max_range, " +
             std::to_string(scan.max_range) + " m");
  }
}

KeyBox voxels_of(const Lattice& lattice, const Eigen::AlignedBox3d& box) {
  constexpr double kOnFace = 1e-6;  // [voxels]
  const Eigen::Array3d low = box.min().array() / lattice.resolution() + Lattice::kOrigin,
                       high = box.max().array() / lattice.resolution() + Lattice::kOrigin;
  const Eigen::Array3d first = (low + kOnFace).floor().max(0.0),
                       last = ((high - kOnFace).ceil() - 1.0).min(Lattice::kKeysPerAxis - 1.0);
  for (Eigen::Index a = 0; a < 3; ++a)
    if (box.min()[a] > box.max()[a])
      throw std::invalid_argument("the box goes from " + decimals_of(box.min()[a]) + " m to " +
                                  decimals_of(box.max()[a]) + " m along " + "xyz"[a] +
                                  ": give the lower corner first");
  for (Eigen::Index a = 0; a < 3; ++a)
    if (!(low[a] < high[a]) || !(first[a] <= last[a]))
      throw std::invalid_argument("the box from " + decimals_of(box.min()[a]) + " m to " +
                                  decimals_of(box.max()[a]) + " m along " + "xyz"[a] +
                                  " holds no voxel of the map, which goes from " +
                                  decimals_of(-Lattice::kOrigin * lattice.resolution()) + " m to " +
                                  decimals_of(Lattice::kOrigin * lattice.resolution()) + " m");
  const auto key = [](const Eigen::Array3d& k) {
    return make_key(std::int64_t(k.x()), std::int64_t(k.y()), std::int64_t(k.z()));
  };
  return {key(first), key(last)};
}

struct Mapping::State {
  detail::ScanTree tree;
  VoxelGrid grid;
  KeyBox bounds;
  double surface_depth;
  InsertionTime time{};
  std::vector<detail::ScanRay> rays{};  // kept for their memory
  std::vector<detail::StateChange> changes{};
  std::vector<VoxelKey> keys{};  // of the last change

  explicit State(const MappingOptions& options)
      : tree(options.resolution, options.sensor_model),
        grid(options.resolution),
        bounds(options.bounds),
        surface_depth(options.surface_depth) {}

  State(const MappingOptions& options, const octomap::OcTree& known)
      : tree(known, options.sensor_model),
        grid(make_voxel_grid(tree)),
        bounds(options.bounds),
        surface_depth(options.surface_depth) {}

  void add_ray(const Eigen::Vector3f& end, bool hit) {
    const auto key = grid.lattice().key(end);
    rays.push_back({end, key.value_or(VoxelKey{}), key.has_value(), hit});
  }

  MapChange insert_rays(const Eigen::Vector3f& origin) {
    Stopwatch watch;
    const auto updates = detail::voxels_of_scan(grid.lattice(), bounds, origin, rays);
    time.rays = watch.lap();
    tree.update(updates, changes);
    time.tree = watch.lap();
    return write_to_grid();
  }

  MapChange write_to_grid() {
    const Stopwatch watch;
    keys.clear();
    for (const auto& [key, state] : changes) {
      grid.set(key, state);
      keys.push_back(key);
    }
    changes.clear();
    std::sort(keys.begin(), keys.end());
    time.mirror = watch.seconds();
    return {grid, keys};
  }
};

Mapping::Mapping(const MappingOptions& options) {
  check(options);
  state_ = std::make_unique<State>(options);
}
Mapping::Mapping(const MappingOptions& options, const octomap::OcTree& known) {
  check(options);
  if (known.getResolution() != options.resolution) {
    std::ostringstream text;
    text.precision(12);
    text << "the map that is known has voxels of " << known.getResolution() << " m, but "
         << options.resolution << " m are asked for";
    throw std::invalid_argument(text.str());
  }
  state_ = std::make_unique<State>(options, known);
}
Mapping::~Mapping() = default;
Mapping::Mapping(Mapping&&) noexcept = default;
Mapping& Mapping::operator=(Mapping&&) noexcept = default;

MapChange Mapping::insert(const Scan& scan) {
  check(scan);
  if (!state_->grid.lattice().key(scan.origin))
    throw std::invalid_argument("the scan begins outside the key range of the map");
  state_->rays.clear();
  const auto depth = static_cast<float>(state_->surface_depth),
             max_range = static_cast<float>(scan.max_range);
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const float range = scan.ranges[i];
    if (std::isnan(range)) continue;
    const bool hit = std::isfinite(range);
    state_->add_ray(scan.origin + scan.directions[i] * (hit ? range + depth : max_range), hit);
  }
  return state_->insert_rays(scan.origin);
}

MapChange Mapping::insert(const Eigen::Vector3f& origin, std::span<const Eigen::Vector3f> points,
                          double max_range) {
  if (!state_->grid.lattice().key(origin))
    throw std::invalid_argument("the scan begins outside the key range of the map");
  if (!(max_range > 0.0))
    throw std::invalid_argument("max_range is " + std::to_string(max_range) + " m, but has to be above 0");
  state_->rays.clear();
  for (const Eigen::Vector3f& point : points) {
    if (!point.allFinite()) continue;
    const Eigen::Vector3f ray = point - origin;
    const double distance = detail::octomap_norm(ray);
    if (distance <= max_range)
      state_->add_ray(point, true);
    else  // as OctoMap shortens it
      state_->add_ray(origin + (ray / static_cast<float>(distance)) * static_cast<float>(max_range), false);
  }
  return state_->insert_rays(origin);
}

MapChange Mapping::mark_free(std::span<const VoxelKey> voxels) {
  for (const VoxelKey& key : voxels)
    if (state_->bounds.contains(key)) state_->tree.set_free(key, state_->changes);
  return state_->write_to_grid();
}

const octomap::OcTree& Mapping::tree() const { return state_->tree; }
const VoxelGrid& Mapping::grid() const { return state_->grid; }
double Mapping::surface_depth() const { return state_->surface_depth; }
const KeyBox& Mapping::bounds() const { return state_->bounds; }
const InsertionTime& Mapping::insertion_time() const { return state_->time; }

void Mapping::write(const std::filesystem::path& file) const { write_octree(state_->tree, file); }

}  // namespace frontlux::planner
