#pragma once

#include <frontlux/lattice.hpp>
#include <frontlux/view_quality.hpp>

#include <cstddef>
#include <vector>

namespace frontlux::bench {

/// The score of each viewpoint by an image: the targets in view at its best yaw.
struct Scores {
  std::vector<double> value;
  std::vector<double> yaw;  ///< [rad]; empty if the image has no azimuth bins

  /// @param opening  [rad] of the camera; not used without azimuth bins
  Scores(const ViewQualityImage& image, double opening);
};

/// How many targets a viewpoint truly sees at this yaw [rad]; at any yaw without azimuth bins.
/// @param truth  an exact image
[[nodiscard]] double true_score(const ViewQualityImage& truth, std::size_t viewpoint, double yaw,
                                double opening);

/// The error of estimates. `rms` to `bias` are relative to the mean true gain, the others are fractions.
struct ViewError {
  double rms = 0;             ///< root of the mean square
  double predicted = 0;       ///< the same of the estimates' own standard errors
  double absolute = 0;        ///< mean absolute
  double bias = 0;            ///< mean
  double missed = 0;          ///< of the viewpoints with a true gain, those with an estimate of 0
  double best_loss = 0;       ///< 1 - true score of the best viewpoint by the estimate / the best true score
  double place_loss = 0;      ///< the same for eq. 1, gain * exp(-lambda * distance), mean over places
  double recounted_loss = 0;  ///< the same, if the `kRecounted` best by the estimate are counted exactly
};

/// The number of best cells that goal selection in space counts exactly.
inline constexpr std::size_t kRecounted = 64;

/// Compares estimates with an exact image; the result is the mean over all estimates.
class ErrorSum {
 public:
  /// @param truth    must outlive this object
  /// @param opening  [rad] of the camera
  /// @param lambda   [1/m] of eq. 1
  /// @param places   number of viewpoints, evenly chosen, that stand for the places of a robot
  /// @throws std::invalid_argument if no viewpoint has a true gain
  ErrorSum(const ViewQualityImage& truth, const Lattice& lattice, double opening, double lambda,
           std::size_t places);

  /// @throws std::invalid_argument if the image has other viewpoints
  void add(const ViewQualityImage& estimate);

  [[nodiscard]] ViewError mean() const;
  [[nodiscard]] double mean_gain() const { return mean_gain_; }

 private:
  // The best score from a place, distance counted, by `value`; its viewpoint.
  [[nodiscard]] std::size_t best_from(std::size_t place, const std::vector<double>& value) const;
  // The truly best, distance counted, among those that are best by `value`.
  [[nodiscard]] double best_recounted(std::size_t place, const std::vector<double>& value) const;
  [[nodiscard]] double discount(std::size_t place, std::size_t viewpoint) const;

  const ViewQualityImage& truth_;
  Lattice lattice_;
  double opening_, lambda_;
  Scores true_scores_;
  std::vector<std::size_t> places_;
  double mean_gain_ = 0;
  std::size_t seeing_ = 0;  // viewpoints with a true gain
  std::size_t count_ = 0;   // of images
  ViewError sum_;           // of squares where a root is to be taken
};

}  // namespace frontlux::bench
