#pragma once

#include <frontlux/export.hpp>
#include <frontlux/field_of_view.hpp>
#include <frontlux/planner/pose.hpp>
#include <frontlux/planner/visible_pairs.hpp>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace frontlux::planner {

/// What a frontier counts if several viewpoints of a path see it.
enum class GainMode : std::uint8_t {
  kOr,   ///< once: the probability that at least one of them detects it
  kSum,  ///< once for each of them, as printed in the paper
};

/// What counts as seen, and how sharply.
struct FRONTLUX_EXPORT GainOptions {
  /// What several views of a frontier count.
  GainMode mode = GainMode::kOr;
  double detection = 0.97;       ///< probability of a detection in full view, in (0, 1); for `kOr`
  double range_sharpness = 4.0;  ///< [1/m] of the logistic that fades the gain out about the maximum range

  /// @throws std::invalid_argument naming the value that is out of bounds
  void check() const;
};

/// The gradient of the gain by one viewpoint.
struct PoseGradient {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [1/m]
  double yaw = 0.0;                                    ///< [1/rad]
};

/// The information gain of a path (the paper's Sec. VII): how many frontiers its viewpoints see, as a
/// differentiable function of the viewpoints' yaws.
///
/// Viewpoint i sees frontier j with membership m_ij in [0, 1]: visibility times a product of logistic
/// functions of the distances to the planes that bound the view, and to its range. `sharpness` is their
/// steepness: as it grows, m_ij tends to 1 in view and to 0 out of view. `distinct` is the number of distinct
/// frontiers that are truly in view.
///
/// Yaws are in [rad], one for each viewpoint, the first and the last included. Whole turns make no
/// difference. For a spinning sensor yaws have no effect.
///
/// Sharpness is in (0, 100]. Wrong sizes, values that are not finite and other sharpnesses throw
/// std::invalid_argument. Thread safety: const members may run at the same time.
class FRONTLUX_EXPORT InformationGain {
 public:
  /// The greatest sharpness that is allowed.
  static constexpr double kMaxSharpness = 100.0;

  /// @param viewpoints  where the sensor is; their yaws are not used
  /// @param frontiers   centres [m]
  /// @param pairs       which of these viewpoints sees which of these frontiers
  InformationGain(std::span<const Pose> viewpoints, std::span<const Eigen::Vector3d> frontiers,
                  const VisiblePairs& pairs, const FieldOfView& view, const GainOptions& options = {});
  // Not inline: code that is compiled for other processors frees Eigen's arrays otherwise.
  ~InformationGain();
  InformationGain(const InformationGain&);
  InformationGain& operator=(const InformationGain&);
  InformationGain(InformationGain&&) noexcept;
  InformationGain& operator=(InformationGain&&) noexcept;

  /// Number of viewpoints of the path.
  [[nodiscard]] std::size_t viewpoints() const { return positions_.size(); }

  /// The differentiable gain.
  /// @param gradient  by the yaws [1/rad], in closed form; not written if empty
  double value(std::span<const double> yaws, double sharpness, std::span<double> gradient = {}) const;

  /// The same from other positions, with its gradient by position and yaw, in closed form. The visible pairs
  /// stay as they were, which is right for small moves only.
  double value_at(std::span<const Pose> poses, double sharpness, std::span<PoseGradient> gradient) const;

  /// The hard gain: distinct frontiers in view (`FieldOfView::contains`) from a viewpoint that sees them.
  [[nodiscard]] std::uint64_t distinct(std::span<const double> yaws) const;

  /// Frontiers that a viewpoint sees at some yaw, ascending: `VisiblePairs::frontiers_of`.
  [[nodiscard]] std::span<const std::uint32_t> frontiers_of(std::size_t viewpoint) const;

  /// For each of `frontiers_of(viewpoint)`: 1 if it is in view at this yaw, else 0.
  void in_view(std::size_t viewpoint, double yaw, std::span<std::uint8_t> in_view) const;

  /// What the sensor sees.
  [[nodiscard]] const FieldOfView& view() const { return view_; }
  /// Number of frontiers.
  [[nodiscard]] std::size_t frontiers() const { return frontiers_.size(); }

 private:
  struct Memberships;
  [[nodiscard]] Memberships memberships(std::span<const double> yaws, double sharpness, bool slopes) const;
  void check_yaws(std::span<const double> yaws) const;
  void check_poses(std::span<const Pose> poses, std::size_t gradients) const;

  std::vector<Eigen::Vector3d> positions_, frontiers_;
  FieldOfView view_;
  GainOptions options_;
  std::vector<std::size_t> first_;    // of each viewpoint's pairs, and the end of the last
  std::vector<std::uint32_t> seen_;   // the frontier of each pair
  std::vector<std::uint8_t> within_;  // 1 where range, and whatever else yaw does not change, allow a view
  Eigen::ArrayXd x_, y_, z_;          // [m] offset of each pair
  Eigen::ArrayXd ux_, uy_, uz_;       // its direction
  Eigen::ArrayXd fade_;               // membership by range
};

/// @throws std::invalid_argument unless it is in (0, InformationGain::kMaxSharpness]
FRONTLUX_EXPORT void check_sharpness(double sharpness);

}  // namespace frontlux::planner
