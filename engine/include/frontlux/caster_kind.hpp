#pragma once

#include <frontlux/export.hpp>
#include <frontlux/octomap.hpp>
#include <frontlux/ray_caster.hpp>
#include <frontlux/voxel_grid.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

namespace frontlux {

/// The casters, for programs that let their user choose one.
enum class CasterKind : std::uint8_t {
  kFast,     ///< `make_ray_caster`
  kEmbree,   ///< `make_embree_ray_caster`; the same answers
  kGrid,     ///< `make_grid_ray_caster`; the same answers
  kOctomap,  ///< `make_octomap_ray_caster`, the baseline; what is visible may differ
};

inline constexpr std::array<std::pair<std::string_view, CasterKind>, 4> kCasterNames = {
    {{"fast", CasterKind::kFast},
     {"embree", CasterKind::kEmbree},
     {"grid", CasterKind::kGrid},
     {"octomap", CasterKind::kOctomap}}};

[[nodiscard]] constexpr std::string_view name_of(CasterKind kind) {
  return kCasterNames[static_cast<std::size_t>(kind)].first;
}

/// The caster with this name; none if there is no such caster.
[[nodiscard]] constexpr std::optional<CasterKind> caster_kind(std::string_view name) {
  for (const auto& [known, kind] : kCasterNames)
    if (known == name) return kind;
  return std::nullopt;
}

/// @param grid  the mirror of `tree`
/// @param tree  if `kind` is kOctomap, queried by reference: must outlive the caster, which shares an
/// `Octree`
/// @throws std::runtime_error if Embree cannot make its device
[[nodiscard]] FRONTLUX_EXPORT std::unique_ptr<RayCaster> make_ray_caster(CasterKind kind,
                                                                         const VoxelGrid& grid,
                                                                         const octomap::OcTree& tree);
[[nodiscard]] FRONTLUX_EXPORT std::unique_ptr<RayCaster> make_ray_caster(CasterKind kind,
                                                                         const VoxelGrid& grid,
                                                                         const octomap::ColorOcTree& tree);
[[nodiscard]] FRONTLUX_EXPORT std::unique_ptr<RayCaster> make_ray_caster(CasterKind kind,
                                                                         const VoxelGrid& grid,
                                                                         const Octree& tree);

}  // namespace frontlux
