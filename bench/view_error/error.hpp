#pragma once

#include <frontlux/lattice.hpp>
#include <frontlux/ray.hpp>
#include <frontlux/view_quality.hpp>

#include <cstddef>
#include <vector>

namespace frontlux::bench {

/// What a robot that chooses by an image gets: at each viewpoint the targets it sees at its best yaw.
struct Scores {
  std::vector<double> value;
  std::vector<double> yaw;  ///< [rad]; empty if the image has no azimuth bins, as all yaws are one then

  /// @param opening  [rad] of the camera; without azimuth bins it does not matter
  Scores(const ViewQualityImage& image, double opening);
};

/// How many of the true targets a viewpoint sees at this yaw [rad]; at any without azimuth bins.
/// @param truth  an exact image
[[nodiscard]] double true_score(const ViewQualityImage& truth, std::size_t viewpoint, double yaw,
                                double opening);

/// How far estimates lie from the truth. Relative to the mean true gain, but for shares.
struct ViewError {
  double rms = 0;             ///< root of the mean square
  double predicted = 0;       ///< the same of the standard errors that the estimates come with
  double absolute = 0;        ///< mean absolute
  double bias = 0;            ///< mean
  double missed = 0;          ///< of the viewpoints that see something, those for which the estimate is 0
  double best_loss = 0;       ///< 1 - what the best by the estimate sees / what the truly best sees
  double place_loss = 0;      ///< the same for eq. 1, gain * exp(-lambda * distance), mean over places
  double recounted_loss = 0;  ///< of that, if the `kRecounted` best by the estimate are looked at exactly
};

/// As many cells as goal selection in space counts exactly, of those that seem best.
inline constexpr std::size_t kRecounted = 64;

/// Compares estimates with an exact image and takes the mean over all.
class ErrorSum {
 public:
  /// @param truth    must outlive this object
  /// @param opening  [rad] of the camera
  /// @param lambda   [1/m] of eq. 1
  /// @param places   how many viewpoints, evenly chosen, stand for places where a robot may be
  /// @throws std::invalid_argument if nothing is seen from anywhere, as nothing is relative to that
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
  std::size_t seeing_ = 0;  // viewpoints that see something
  std::size_t count_ = 0;   // of images
  ViewError sum_;           // of squares where a root is to be taken
};

}  // namespace frontlux::bench
