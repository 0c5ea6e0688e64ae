#include "peers/open3d_peer.hpp"

#include "embree/blocker_boxes.hpp"

#include <frontlux/parallel.hpp>
#include <frontlux/stopwatch.hpp>

#include <open3d/core/Tensor.h>
#include <open3d/t/geometry/RaycastingScene.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

namespace frontlux::bench {
namespace {

using open3d::core::Tensor;

struct Triangles {
  std::vector<float> corners;         // x, y, z of each [voxels]
  std::vector<std::uint32_t> places;  // of the corners of each triangle

  void add(const std::array<float, 3>& low, const std::array<float, 3>& high) {
    // Corner i is high along x, y and z where its bits 0, 1 and 2 are set.
    constexpr std::array<std::array<std::uint32_t, 4>, 6> kFaces = {
        {{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}}};
    const auto first = static_cast<std::uint32_t>(corners.size() / 3);
    for (std::uint32_t i = 0; i < 8; ++i)
      for (std::size_t a = 0; a < 3; ++a) corners.push_back(((i >> a) & 1U) != 0 ? high[a] : low[a]);
    for (const auto& face : kFaces)
      for (const std::array<std::size_t, 3>& half : {std::array<std::size_t, 3>{0, 1, 2}, {0, 2, 3}})
        for (const std::size_t i : half) places.push_back(first + face[i]);
  }
};

// Coordinates are voxels from a key in the middle of the map, where single precision has the most bits left.
std::array<float, 3> from_middle(int x, int y, int z, const VoxelKey& middle) {
  return {static_cast<float>(x - middle.x), static_cast<float>(y - middle.y),
          static_cast<float>(z - middle.z)};
}

Triangles triangles_of(const VoxelGrid& grid, const VoxelKey& middle) {
  Triangles triangles;
  for (const auto& group : detail::make_blockers(grid, UnknownPolicy::kBlock).groups)
    for (std::size_t i = 0; i < group->boxes.size(); ++i) {
      const KeyBox box = group->box(i);
      triangles.add(from_middle(box.min.x, box.min.y, box.min.z, middle),
                    from_middle(box.max.x + 1, box.max.y + 1, box.max.z + 1, middle));
    }
  return triangles;
}

// A ray of length 1 from centre to centre, without what lies in the target.
std::array<float, 6> ray_of(const KeySegment& segment, const VoxelKey& middle) {
  constexpr float kShort = 0.01F;  // [voxels] before the target
  std::array<float, 3> from = from_middle(segment.from.x, segment.from.y, segment.from.z, middle);
  const std::array<float, 3> to = from_middle(segment.to.x, segment.to.y, segment.to.z, middle);
  std::array<float, 6> ray{};
  float longest = 0.0F;
  for (std::size_t a = 0; a < 3; ++a) longest = std::max(longest, std::abs(to[a] - from[a]));
  const float part = longest > 0.0F ? 1.0F - (0.5F + kShort) / longest : 0.0F;
  for (std::size_t a = 0; a < 3; ++a) {
    ray[a] = from[a] + 0.5F;
    ray[3 + a] = (to[a] - from[a]) * part;
  }
  return ray;
}

void add(open3d::t::geometry::RaycastingScene& scene, const Triangles& triangles) {
  const auto rows = [](std::size_t numbers) { return static_cast<std::int64_t>(numbers / 3); };
  scene.AddTriangles(
      Tensor(triangles.corners.data(), {rows(triangles.corners.size()), 3}, open3d::core::Float32),
      Tensor(triangles.places.data(), {rows(triangles.places.size()), 3}, open3d::core::UInt32));
}

bool hits_a_box() {
  Triangles box;
  box.add({-1, -1, -1}, {1, 1, 1});
  open3d::t::geometry::RaycastingScene scene;
  add(scene, box);
  const std::array<float, 6> ray = {-3, 0.3F, 0.2F, 6, 0, 0};
  return scene.TestOcclusions(Tensor(ray.data(), {1, 6}, open3d::core::Float32)).GetDataPtr<bool>()[0];
}

}  // namespace

std::optional<Peer> make_open3d_peer(const VoxelGrid& grid) {
  if (!hits_a_box()) return std::nullopt;
  const Stopwatch watch;
  const KeyBox known = grid.known_bounds().value_or(KeyBox{});
  const VoxelKey middle = make_key((known.min.x + known.max.x) / 2, (known.min.y + known.max.y) / 2,
                                   (known.min.z + known.max.z) / 2);
  const auto scene = std::make_shared<open3d::t::geometry::RaycastingScene>();
  std::size_t bytes = 0;
  {
    const Triangles triangles = triangles_of(grid, middle);
    add(*scene, triangles);
    bytes = triangles.corners.size() * sizeof(float) + triangles.places.size() * sizeof(std::uint32_t);
  }
  const auto query = [scene, middle](std::span<const KeySegment> segments, std::span<std::uint8_t> answers) {
    Tensor rays = Tensor::Empty({static_cast<std::int64_t>(segments.size()), 6}, open3d::core::Float32);
    auto* numbers = rays.GetDataPtr<float>();
    for_each_chunk(segments.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i != end; ++i) {
        const auto ray = ray_of(segments[i], middle);
        std::copy(ray.begin(), ray.end(), numbers + 6 * i);
      }
    });
    const Tensor hit = scene->TestOcclusions(rays, 0.0F, 1.0F, tbb::this_task_arena::max_concurrency());
    const auto* hits = hit.GetDataPtr<bool>();
    for (std::size_t i = 0; i < segments.size(); ++i) answers[i] = hits[i] ? 0 : 1;
  };
  const std::array<KeySegment, 1> one{KeySegment{middle, middle}};
  std::array<std::uint8_t, 1> answer{};
  query(one, answer);  // builds the BVH
  std::optional<Peer> peer(std::in_place);
  peer->caster = "open3d";
  peer->build_seconds = watch.seconds();
  peer->bytes = bytes;
  peer->visible = query;
  return peer;
}

}  // namespace frontlux::bench
