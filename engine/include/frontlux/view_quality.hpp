#pragma once

#include <frontlux/export.hpp>
#include <frontlux/field_of_view.hpp>
#include <frontlux/lattice.hpp>
#include <frontlux/map_change.hpp>
#include <frontlux/ray.hpp>
#include <frontlux/ray_caster.hpp>
#include <frontlux/voxel_grid.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace frontlux {

class ViewRegion;

namespace detail {
class AzimuthBins;
class RayTries;
class TargetIndex;
struct Kept;
struct Viewpoint;
}  // namespace detail

/// How the view quality of a viewpoint is estimated.
struct FRONTLUX_EXPORT ViewQualityOptions {
  /// How the visible targets are found.
  enum class Renderer : std::uint8_t {
    kRays,   ///< by a ray to each of the targets that are drawn
    kExact,  ///< all feasible targets, for many viewpoints at once: the values of `kRays` with `kAll` and
             ///< `Sampling::kFeasible`, many times as fast where viewpoints have neighbours. Ignores
             ///< `samples`, `sampling`, `estimator` and `seed`
  };
  /// What the targets are drawn from.
  enum class Sampling : std::uint8_t {
    kFeasible,  ///< the targets that are in the field of view at some yaw; all of them are listed
    kBuckets,   ///< all targets in the blocks of 8 x 8 x 8 voxels that may be in view: their number is known
                ///< without a list. Drawn targets that are not in view count as not visible
  };
  /// How the gain is estimated from the visible among the drawn targets.
  enum class Estimator : std::uint8_t {
    kUnbiased,  ///< gain = population * hits / drawn
    kPaper,     ///< gain = hits, which saturates at `samples`; with `Sampling::kFeasible` only
  };
  /// For `samples`: never draw, always look at every target.
  static constexpr int kAll = std::numeric_limits<int>::max();

  /// How visible targets are found.
  Renderer renderer = Renderer::kRays;
  int samples = 64;  ///< most targets drawn for a viewpoint; if there are no more than that, all are taken
  /// Which targets are drawn from.
  Sampling sampling = Sampling::kFeasible;
  /// How gains follow from the drawn targets.
  Estimator estimator = Estimator::kUnbiased;
  /// Of the draws.
  std::uint64_t seed = 1;
  int azimuth_bins = 0;  ///< equal sectors of the horizon in which visible targets are counted; 0: none

  /// The most azimuth bins.
  static constexpr int kMaxAzimuthBins = 3600;

  /// @throws std::invalid_argument naming the value that is out of bounds
  void check() const;
};

/// What a viewpoint would see.
struct FRONTLUX_EXPORT ViewQuality {
  std::uint32_t population = 0;  ///< targets drawn from: those in view at some yaw, or those in the buckets
  std::uint32_t drawn = 0;       ///< of them, without replacement
  std::uint32_t hits = 0;        ///< of the drawn: in view at some yaw and visible
  double gain = 0.0;             ///< estimated number of visible targets, or `hits` with `Estimator::kPaper`
  /// Of `gain`: sqrt((1 - drawn / population) q (1 - q) / (drawn - 1)), times population (paper: times
  /// drawn), with q = (hits + 1) / (drawn + 2). 0 only if all were drawn: 0 hits in 64 draws prove nothing.
  double standard_error = 0.0;

  /// `gain` for each of `hits`.
  [[nodiscard]] double gain_per_hit() const { return hits == 0 ? 0.0 : gain / hits; }
  /// `standard_error`, if only so many of the hits counted: `hits` is replaced in the formula.
  [[nodiscard]] double standard_error_of(std::uint64_t some_hits,
                                         ViewQualityOptions::Estimator estimator) const;
  friend bool operator==(const ViewQuality&, const ViewQuality&) = default;
};

/// Neighbouring azimuth bins that fit into a camera's opening angle.
struct AzimuthWindow {
  double yaw = 0.0;        ///< [rad] of its middle, in [-pi, pi]
  std::uint64_t hits = 0;  ///< visible targets in it
};

/// The window with the most hits; of equals the one that starts first, counted from azimuth 0 upwards.
/// @param bin_hits    visible targets in equal sectors of the horizon; bin b of n starts at b / n of a turn
/// @param opening     [rad] a window has as many whole bins as fit into this angle, at most all
/// @param containing  [rad] if given, only windows with the bin of this azimuth are considered
/// @throws std::invalid_argument if there is no bin, if not even one fits, or if an angle is not finite
[[nodiscard]] FRONTLUX_EXPORT AzimuthWindow best_window(std::span<const std::uint32_t> bin_hits,
                                                        double opening,
                                                        std::optional<double> containing = std::nullopt);

/// The view quality of many viewpoints (the paper's Monte-Carlo rendering, Sec. V), which is updated as the
/// map changes.
///
/// A viewpoint's value depends only on the map, the field of view, the targets near it, the options and its
/// own key: not on the other viewpoints, their order, the caster (OctoMap's own aside) or the number of
/// threads. The random numbers are keyed by seed and viewpoint alone, so that a viewpoint keeps its value as
/// long as nothing changes around it. Its draws repeat, which does no harm: a change of the targets shuffles
/// them.
///
/// Thread safety: as a standard container.
class FRONTLUX_EXPORT ViewQualityImage {
 public:
  /// An image without viewpoints.
  /// @param lattice  of the keys
  /// @throws std::invalid_argument naming the value that is out of bounds, also if the range is longer than
  ///                               `ViewRegion::kMaxRange` voxels
  ViewQualityImage(const Lattice& lattice, const FieldOfView& field_of_view,
                   const ViewQualityOptions& options);

  /// Renders every viewpoint.
  /// @param caster      of the map, not updated meanwhile. Occupied and unknown voxels block, except the
  /// target's and the viewpoint's
  /// @param viewpoints  sensor positions, in any order
  /// @param targets     voxels to be seen, in any order; repeated ones count once
  /// @throws std::invalid_argument if the caster's map has another resolution, as `update` does
  void render(const RayCaster& caster, std::span<const VoxelKey> viewpoints,
              std::span<const VoxelKey> targets);

  /// Renders only the viewpoints that are new, and those that a changed voxel or a new or former target may
  /// concern. The image is afterwards the same as after `render`.
  /// @param caster  of the map as it is now, not updated meanwhile
  /// @param change  since the last call
  /// @return number of viewpoints that were rendered
  std::size_t update(const RayCaster& caster, std::span<const VoxelKey> viewpoints,
                     std::span<const VoxelKey> targets, const MapChange& change);

  /// Number of viewpoints.
  [[nodiscard]] std::size_t size() const { return viewpoints_.size(); }
  /// The viewpoints, in the order given.
  [[nodiscard]] std::span<const VoxelKey> viewpoints() const { return viewpoints_; }
  /// `values()[i]` belongs to `viewpoints()[i]`.
  [[nodiscard]] std::span<const ViewQuality> values() const { return values_; }
  /// The place of the viewpoint with the greatest gain; of equals the first. @pre size() > 0
  [[nodiscard]] std::size_t best() const;
  /// Visible targets among the drawn ones of viewpoint `i` in each azimuth bin, for `best_window`; empty
  /// without `azimuth_bins`. Times `gain_per_hit()` they are estimates of all visible targets. @pre i <
  /// size()
  [[nodiscard]] std::span<const std::uint32_t> bin_hits(std::size_t i) const {
    return std::span(bin_hits_).subspan(i * bins(), bins());
  }

  /// As given.
  [[nodiscard]] const ViewQualityOptions& options() const { return options_; }

 private:
  // `kept`: for each of the sorted viewpoints.
  std::size_t remake(const RayCaster& caster, std::span<const VoxelKey> viewpoints,
                     std::shared_ptr<const std::vector<detail::Viewpoint>> order,
                     std::shared_ptr<const detail::TargetIndex> targets, std::span<const detail::Kept> kept);
  [[nodiscard]] std::size_t bins() const { return static_cast<std::size_t>(options_.azimuth_bins); }

  double resolution_;  // [m]
  ViewQualityOptions options_;
  std::shared_ptr<const ViewRegion> region_;
  std::shared_ptr<const detail::AzimuthBins> azimuth_bins_;
  std::shared_ptr<detail::RayTries> tries_;
  std::shared_ptr<const detail::TargetIndex> targets_;
  std::vector<VoxelKey> viewpoints_;
  std::shared_ptr<const std::vector<detail::Viewpoint>> order_;  // the viewpoints, sorted by place
  std::vector<ViewQuality> values_;
  std::vector<std::uint32_t> bin_hits_;
};

/// Renders an image from scratch: see `ViewQualityImage`.
[[nodiscard]] FRONTLUX_EXPORT ViewQualityImage render_view_quality(const RayCaster& caster,
                                                                   const Lattice& lattice,
                                                                   std::span<const VoxelKey> viewpoints,
                                                                   std::span<const VoxelKey> targets,
                                                                   const FieldOfView& field_of_view,
                                                                   const ViewQualityOptions& options = {});

}  // namespace frontlux
