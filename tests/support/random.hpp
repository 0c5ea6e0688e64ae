#pragma once

#include "support/test.hpp"

#include <frontlux/key_box.hpp>
#include <frontlux/voxel_grid.hpp>

#include <Eigen/Core>

#include <random>

namespace frontlux::test {

/// Seeded random numbers that are the same everywhere (the standard's distributions are not).
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  std::uint64_t bits() { return engine_(); }
  /// 0 <= n < count
  int below(int count) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(count)); }
  bool one_in(int count) { return below(count) == 0; }
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  /// One of some values. @pre there is one
  template <class Values>
  const auto& pick(const Values& values) {
    return values[static_cast<std::size_t>(below(static_cast<int>(values.size())))];
  }
  template <class Values>
  void shuffle(Values& values) {
    for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[bits() % i]);
  }
  /// Each coordinate between `low` and `high`.
  Eigen::Vector3d point(double low, double high) {
    const double x = uniform(low, high), y = uniform(low, high);
    return {x, y, uniform(low, high)};
  }
  VoxelKey key_in(const KeyBox& box) {
    const auto along = [&](int low, int high) { return low + below(high - low + 1); };
    const int x = along(box.min.x, box.max.x), y = along(box.min.y, box.max.y);
    return make_key(x, y, along(box.min.z, box.max.z));
  }
  /// A block whose edge is 1 << log2_edge voxels, with its corner in the box but for its alignment.
  Block block_in(const KeyBox& box, int log2_edge) {
    const auto aligned = [&](int at) { return at >> log2_edge << log2_edge; };
    const VoxelKey key = key_in(box);
    return {make_key(aligned(key.x), aligned(key.y), aligned(key.z)), log2_edge};
  }
  Occupancy state() { return static_cast<Occupancy>(below(3)); }

 private:
  std::mt19937_64 engine_;
};

}  // namespace frontlux::test
