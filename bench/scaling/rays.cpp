#include "scaling/rays.hpp"

#include "random.hpp"
#include "rays/free_voxels.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>

namespace frontlux::bench {
namespace {

enum Stream : std::uint64_t { kViewpoint = 201, kDirection, kPoint, kOrder };

// In a flat map most directions of long rays end outside of it, and have to be drawn again.
constexpr std::size_t kTries = 256 * kTargetsPerViewpoint;
constexpr double kSteepest = 0.3420201433;  // sine of 20 degrees

/// Free voxels in a box, drawn from equal parts of all that it holds.
std::vector<VoxelKey> draw_viewpoints(const VoxelGrid& grid, const KeyBox& within, std::size_t count) {
  if (within == kAllVoxels) return sample_free_voxels(grid, count, std::nullopt, kViewpoint);
  VoxelGrid here(grid.resolution());
  const auto common = intersection(within, grid.known_bounds().value_or(within));
  if (common) for_each_key(*common, [&](const VoxelKey& key) { here.set(key, grid.at(key)); });
  return sample_free_voxels(here, count, std::nullopt, kViewpoint);
}

/// Free voxels around one viewpoint, each once.
std::vector<VoxelKey> draw_targets(const VoxelGrid& grid, const VoxelKey& from, std::size_t number,
                                   double voxels, std::size_t count) {
  std::vector<VoxelKey> targets;
  for (std::size_t i = 0; i < kTries && targets.size() < count; ++i) {
    const std::uint64_t draw = 2 * (number * kTries + i);
    const double azimuth = 2 * std::numbers::pi * uniform(kDirection, draw);
    const double z = kSteepest * (2 * uniform(kDirection, draw + 1) - 1);
    const double horizontal = std::sqrt(1 - z * z);
    const auto along = [voxels](double part) { return static_cast<int>(std::round(voxels * part)); };
    const auto to = offset_key(from, along(horizontal * std::cos(azimuth)),
                               along(horizontal * std::sin(azimuth)), along(z));
    if (to && grid.at(*to) == Occupancy::kFree) targets.push_back(*to);
  }
  std::sort(targets.begin(), targets.end());
  targets.erase(std::unique(targets.begin(), targets.end()), targets.end());
  return targets;
}

template <class Item>
void shuffle(std::vector<Item>& items, std::uint64_t stream) {
  for (std::size_t i = items.size(); i > 1; --i) {
    const auto other = static_cast<std::size_t>(uniform(stream, i) * static_cast<double>(i));
    std::swap(items[i - 1], items[other]);
  }
}

}  // namespace

std::vector<KeySegment> segments_of_length(const VoxelGrid& grid, double length, std::size_t count,
                                           const KeyBox& within) {
  const double voxels = std::min(length / grid.resolution(), 2.0 * Lattice::kKeysPerAxis);
  if (!(voxels >= 2 && std::isfinite(length)))
    throw std::invalid_argument("segments_of_length: length is " + std::to_string(length) +
                                " m, must be two voxels of " + std::to_string(grid.resolution()) +
                                " m at least");
  const std::size_t viewpoints = (count + kTargetsPerViewpoint - 1) / kTargetsPerViewpoint;
  std::vector<KeySegment> segments;
  segments.reserve(count);
  const auto places = draw_viewpoints(grid, within, viewpoints);
  for (std::size_t place = 0; place < places.size(); ++place) {
    const std::size_t missing = std::min(kTargetsPerViewpoint, count - segments.size());
    for (const VoxelKey& to : draw_targets(grid, places[place], place, voxels, missing))
      segments.push_back({places[place], to});
  }
  return segments;
}

std::vector<Ray> rays_along(std::span<const KeySegment> segments, const Lattice& lattice, double range) {
  std::vector<Ray> rays;
  rays.reserve(segments.size());
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const auto shift = [&](std::uint64_t axis) {
      return static_cast<float>((uniform(kPoint, 3 * i + axis) - 0.5) * 0.8 * lattice.resolution());
    };
    const Eigen::Vector3f center = lattice.center(segments[i].from);
    rays.push_back({center + Eigen::Vector3f(shift(0), shift(1), shift(2)),
                    lattice.center(segments[i].to) - center, range});
  }
  return rays;
}

Workload shuffled(Workload workload) {
  shuffle(workload.segments, kOrder);
  for (RayBatch& batch : workload.batches) shuffle(batch.rays, kOrder);
  return workload;
}

}  // namespace frontlux::bench
