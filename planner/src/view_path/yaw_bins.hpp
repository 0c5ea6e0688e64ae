#pragma once

#include "view_path/yaw_limits.hpp"

#include <frontlux/planner/information_gain.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace frontlux::planner {

/// A few yaws for each viewpoint of a path, the frontiers truly in view at each, and choices among them. Of
/// yaws that see as many the nearest to the path's tangent is chosen: a robot looks where it goes unless
/// there is more to see elsewhere.
class YawBins {
 public:
  static constexpr int kMaxBins = 63;  // a bit each, and one for the even turn

  /// The first and the last viewpoint have their one yaw. The others have `bins` around the circle and, if
  /// turning is limited, that of the even turn.
  /// @param tangent  yaws along the path [rad], those of the first and the last viewpoint included
  YawBins(const InformationGain& gain, int bins, std::span<const double> tangent, const YawLimits& limits);

  /// The yaws with most views within the limits. A frontier counts once for each viewpoint that sees it.
  [[nodiscard]] std::vector<double> most_views() const;

  /// Yaws with many distinct frontiers in view, within the limits: chosen greedily, then improved viewpoint
  /// by viewpoint until no single turn adds a frontier.
  [[nodiscard]] std::vector<double> most_distinct() const;

 private:
  using Choice = std::vector<std::size_t>;  // which of its yaws each viewpoint takes
  // How good a yaw is: by its views, and of as many by how near it is to the tangent.
  [[nodiscard]] std::vector<std::int64_t> scores(std::size_t viewpoint,
                                                 std::span<const std::uint32_t> covered) const;
  [[nodiscard]] Choice best_sequence() const;
  [[nodiscard]] Choice greedy_choice(std::vector<std::uint32_t>& covered) const;
  void sweep(Choice& choice, std::vector<std::uint32_t>& covered) const;
  void cover(std::size_t viewpoint, std::size_t bin, std::uint32_t by,
             std::vector<std::uint32_t>& covered) const;
  [[nodiscard]] std::vector<double> yaws_of(const Choice& choice) const;

  const InformationGain& gain_;
  const YawLimits& limits_;
  std::vector<std::vector<double>> yaws_;
  std::vector<std::vector<std::int64_t>> nearness_;  // of each yaw to the tangent, 0 to kNearest
  std::vector<std::vector<std::uint64_t>> in_view_;  // bits by yaw, for each of the viewpoint's frontiers
};

}  // namespace frontlux::planner
