#include "rays/workload.hpp"

#include "random.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace frontlux::bench {
namespace {

constexpr std::size_t kMinRays = 20'000, kMaxRays = 400'000, kPilotRays = 4'096;

constexpr double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

/// Random numbers of different uses must not be the same ones.
enum Stream : std::uint64_t {
  kViewpoint = 1,
  kScanPosition,
  kScanHeading,
  kBlockOrigin,
  kPassOrigin,
  kPointInVoxel,
  kDirection,
};

/// The range and the opening of a sensor.
struct Reach {
  double range;      ///< [m]
  double elevation;  ///< [rad] up and down from the horizon
};

/// Calls `visit` for every target in the field of view of a viewpoint.
template <class Visit>
void for_each_in_reach(const VoxelIndex& targets, const VoxelKey& viewpoint, const Reach& reach,
                       double resolution, Visit&& visit) {
  const double radius = reach.range / resolution;
  const double slope = std::tan(reach.elevation);
  targets.for_each_near(viewpoint, static_cast<int>(std::min(radius, 65535.0)), [&](const VoxelKey& target) {
    const double x = target.x - viewpoint.x, y = target.y - viewpoint.y, z = target.z - viewpoint.z;
    const double horizontal = x * x + y * y;
    if (horizontal + z * z <= radius * radius && z * z <= slope * slope * horizontal) visit(target);
  });
}

/// Every k-th of all pairs of a viewpoint and a target in its reach.
std::vector<KeySegment> sample_pairs(const std::vector<VoxelKey>& viewpoints, const VoxelIndex& targets,
                                     const Reach& reach, double resolution, std::size_t count) {
  std::uint64_t total = 0;
  for (const VoxelKey& from : viewpoints)
    for_each_in_reach(targets, from, reach, resolution, [&](const VoxelKey&) { ++total; });
  std::vector<KeySegment> pairs;
  pairs.reserve(std::min<std::uint64_t>(count, total));
  std::uint64_t seen = 0;
  for (const VoxelKey& from : viewpoints) {
    for_each_in_reach(targets, from, reach, resolution, [&](const VoxelKey& to) {
      ++seen;
      if (total <= count || seen * count / total != (seen - 1) * count / total) pairs.push_back({from, to});
    });
  }
  return pairs;
}

Eigen::Vector3f point_in_voxel(const Lattice& lattice, const VoxelKey& key, double spread,
                               std::uint64_t stream, std::uint64_t index) {
  const auto shift = [&](std::uint64_t axis) {
    return static_cast<float>((uniform(stream, 3 * index + axis) - 0.5) * spread * lattice.resolution());
  };
  return lattice.center(key) + Eigen::Vector3f(shift(0), shift(1), shift(2));
}

/// Scans of 32 beams by 720 azimuths between -20 and 20 degrees. Of every scan only a sector, in full
/// density: the rays are in the order of a lidar, and there are enough for many positions.
RayBatch lidar(const VoxelGrid& grid, std::size_t count, double range) {
  constexpr std::size_t kBeams = 32, kAzimuths = 720, kSector = 45, kMinScans = 16;
  const std::size_t scans = std::max(kMinScans, count / (kSector * kBeams));
  const std::size_t sector = std::clamp(count / (scans * kBeams), std::size_t{1}, kAzimuths);
  RayBatch batch{{}, UnknownPolicy::kPass};
  const auto positions = sample_free_voxels(grid, scans, std::nullopt, kScanPosition);
  batch.rays.reserve(positions.size() * sector * kBeams);
  for (std::size_t scan = 0; scan < positions.size(); ++scan) {
    const Eigen::Vector3f origin = point_in_voxel(grid.lattice(), positions[scan], 0.8, kPointInVoxel, scan);
    const double heading = uniform(kScanHeading, scan) * radians(360);
    for (std::size_t a = 0; a < sector; ++a) {
      const double azimuth = heading + static_cast<double>(a) * radians(360.0 / kAzimuths);
      for (std::size_t b = 0; b < kBeams; ++b) {
        const double elevation = radians(-20.0 + 40.0 * static_cast<double>(b) / (kBeams - 1));
        const Eigen::Vector3d direction(std::cos(azimuth) * std::cos(elevation),
                                        std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
        batch.rays.push_back({origin, direction.cast<float>(), range});
      }
    }
  }
  return batch;
}

/// Rays in all directions from anywhere in free space.
RayBatch random_rays(const VoxelGrid& grid, std::size_t count, double range, UnknownPolicy unknown) {
  // An unlimited ray that ignores unknown walks to the end of the key range, thousands of times as far as
  // the others: with more than these few, nothing else would be measured.
  constexpr std::size_t kUnlimitedEvery = 16'384;
  const Stream stream = unknown == UnknownPolicy::kBlock ? kBlockOrigin : kPassOrigin;
  RayBatch batch{{}, unknown};
  const auto origins = sample_free_voxels(grid, count, std::nullopt, stream);
  batch.rays.reserve(origins.size());
  for (std::size_t i = 0; i < origins.size(); ++i) {
    const std::uint64_t number = 2 * i + (unknown == UnknownPolicy::kBlock ? 0 : 1);
    const double azimuth = uniform(kDirection, 2 * number) * radians(360);
    const double z = 2 * uniform(kDirection, 2 * number + 1) - 1;
    const double horizontal = std::sqrt(1 - z * z);
    const Eigen::Vector3d direction(horizontal * std::cos(azimuth), horizontal * std::sin(azimuth), z);
    batch.rays.push_back({point_in_voxel(grid.lattice(), origins[i], 1.0, kPointInVoxel, number),
                          direction.cast<float>(),
                          i % kUnlimitedEvery == kUnlimitedEvery / 2 ? -1.0 : range});
  }
  return batch;
}

double steps_between(const VoxelKey& a, const VoxelKey& b) {
  return std::abs(a.x - b.x) + std::abs(a.y - b.y) + std::abs(a.z - b.z);
}

double total_voxels(std::span<const Ray> rays, UnknownPolicy unknown, const RayCaster& caster,
                    const Lattice& lattice) {
  std::vector<Hit> hits(rays.size());
  caster.cast(rays, hits, unknown);
  double total = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    // The path steps through faces and never back, so its length is the distance along the axes.
    const auto origin = lattice.key(rays[i].origin);
    if (origin && hits[i].stop != RayStop::kInvalid) total += steps_between(*origin, hits[i].key);
  }
  return total;
}

}  // namespace

std::size_t Workload::size() const {
  std::size_t count = segments.size();
  for (const RayBatch& batch : batches) count += batch.rays.size();
  return count;
}

WorkloadSource::WorkloadSource(const VoxelGrid& grid, const RayCaster& caster)
    : grid_(grid), caster_(caster) {}

Workload WorkloadSource::make(std::string_view name, std::optional<std::size_t> rays) {
  Workload workload{std::string(name), {}, {}, {}};
  if (grid_.count()[static_cast<std::size_t>(Occupancy::kFree)] == 0) {
    workload.skipped = "the map has no free voxel";
  } else {
    if (!rays) {
      const double length = mean_voxels(draw(name, kPilotRays), caster_, grid_.lattice());
      rays = std::clamp(static_cast<std::size_t>(kVoxelsPerPass / std::max(length, 1.0)), kMinRays, kMaxRays);
    }
    workload = draw(name, *rays);
    if (workload.size() == 0) workload.skipped = "no frontier is in reach of a free voxel";
  }
  return workload;
}

Workload WorkloadSource::draw(std::string_view name, std::size_t rays) {
  Workload workload{std::string(name), {}, {}, {}};
  if (name == "visible_ugv" || name == "visible_uav") {
    const bool ground = name == "visible_ugv";
    const Reach reach = ground ? Reach{6.0, radians(20)} : Reach{10.0, radians(36)};
    const auto viewpoints = sample_free_voxels(grid_, std::max(rays / 256, std::size_t{256}),
                                               ground ? fullest_free_plane(grid_) : std::nullopt, kViewpoint);
    workload.segments = sample_pairs(viewpoints, frontiers(), reach, grid_.resolution(), rays);
  } else if (name == "cast_random") {
    workload.batches.push_back(random_rays(grid_, rays / 2, 10.0, UnknownPolicy::kBlock));
    workload.batches.push_back(random_rays(grid_, rays - rays / 2, 10.0, UnknownPolicy::kPass));
  } else {
    workload.batches.push_back(lidar(grid_, rays, 30.0));
  }
  return workload;
}

const VoxelIndex& WorkloadSource::frontiers() {
  if (!frontiers_) frontiers_.emplace(voxels_beside_free(grid_, Occupancy::kUnknown));
  return *frontiers_;
}

double mean_voxels(const Workload& workload, const RayCaster& caster, const Lattice& lattice) {
  if (workload.size() == 0) return 0;
  double total = 0;
  for (const RayBatch& batch : workload.batches)
    total += total_voxels(batch.rays, batch.unknown, caster, lattice);
  std::vector<Ray> rays;
  rays.reserve(workload.segments.size());
  for (const KeySegment& segment : workload.segments) {
    const Eigen::Vector3f from = lattice.center(segment.from), to = lattice.center(segment.to);
    rays.push_back({from, to - from, (to - from).norm() + lattice.resolution() / 2});
  }
  total += total_voxels(rays, UnknownPolicy::kBlock, caster, lattice);
  return total / static_cast<double>(workload.size());
}

}  // namespace frontlux::bench
