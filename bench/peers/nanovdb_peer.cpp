#include "peers/nanovdb_peer.hpp"

#include <frontlux/parallel.hpp>

#include <nanovdb/util/GridBuilder.h>
#include <nanovdb/util/HDDA.h>
#include <nanovdb/util/Ray.h>

#include <memory>

namespace frontlux::bench {
namespace {

nanovdb::Coord coord(const VoxelKey& key) {
  return {key.x - Lattice::kOrigin, key.y - Lattice::kOrigin, key.z - Lattice::kOrigin};
}

nanovdb::Vec3f center(const VoxelKey& key) {
  const nanovdb::Coord c = coord(key);
  return {static_cast<float>(c.x()) + 0.5F, static_cast<float>(c.y()) + 0.5F,
          static_cast<float>(c.z()) + 0.5F};
}

nanovdb::GridHandle<> build(const VoxelGrid& grid) {
  nanovdb::GridBuilder<float> builder(0.0F);
  auto voxels = builder.getAccessor();
  const auto activate = [&](const VoxelKey& key) { voxels.setValue(coord(key), 1.0F); };
  for (const Occupancy state : {Occupancy::kOccupied, Occupancy::kUnknown}) {
    for (const VoxelKey& key : voxels_beside_free(grid, state)) {
      activate(key);
      for_each_neighbour(key, [&](const VoxelKey& behind) {
        if (grid.at(behind) != Occupancy::kFree) activate(behind);
      });
    }
  }
  return builder.getHandle<>();
}

bool visible(const KeySegment& segment, nanovdb::DefaultReadAccessor<float>& voxels) {
  if (segment.from == segment.to) return true;
  const nanovdb::Vec3f from = center(segment.from);
  nanovdb::Vec3f direction = center(segment.to) - from;
  const float length = direction.length();
  direction /= length;
  nanovdb::Ray<float> ray(from, direction, 1e-6F, length);
  nanovdb::Coord met;
  float time = 0;
  // The march may step over the target into the voxel behind; that counts as the target.
  return !nanovdb::firstActive(ray, voxels, met, time) || met == coord(segment.to) || time >= length;
}

}  // namespace

Peer make_nanovdb_peer(const VoxelGrid& grid) {
  const auto handle = std::make_shared<nanovdb::GridHandle<>>();
  const double seconds = median_seconds([&] { *handle = build(grid); });
  const auto query = [handle](std::span<const KeySegment> segments, std::span<std::uint8_t> answers) {
    const nanovdb::NanoGrid<float>& voxels = *handle->grid<float>();
    for_each_chunk(segments.size(), 256, [&](std::size_t begin, std::size_t end) {
      auto accessor = voxels.getAccessor();
      for (std::size_t i = begin; i != end; ++i) answers[i] = visible(segments[i], accessor) ? 1 : 0;
    });
  };
  return {{"nanovdb", seconds, 0.0, static_cast<std::size_t>(handle->size())}, query};
}

}  // namespace frontlux::bench
