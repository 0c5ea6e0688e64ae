#pragma once

#include "embree/box_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace frontlux::detail {

/// The order in which probes are cast: among those that start at one point, similar directions come after
/// each other, whatever the caller's order.
class ProbeOrder {
 public:
  explicit ProbeOrder(std::span<const Probe> probes) {
    float length = 0.0F;
    std::size_t begin = 0, origins = 0;
    for (std::size_t i = 0; i < probes.size(); ++i) {
      const Probe& p = probes[i];
      length += std::max(p.t_far - p.t_near, 0.0F) *
                std::max({std::fabs(p.direction[0]), std::fabs(p.direction[1]), std::fabs(p.direction[2])});
      if (i + 1 < probes.size() && std::equal(p.origin, p.origin + 3, probes[i + 1].origin)) continue;
      sort_by_direction(probes, begin, i + 1);
      begin = i + 1;
      ++origins;
    }
    share_origins_ = probes.size() >= kSharing * origins;
    mean_length_ = length / static_cast<float>(std::max<std::size_t>(probes.size(), 1));
  }
  [[nodiscard]] std::size_t operator[](std::size_t i) const { return order_[i]; }
  /// Whether so many probes start at one point that packets of neighbours may be faster than one after
  /// another.
  [[nodiscard]] bool share_origins() const { return share_origins_; }
  /// Of a probe, in voxels, along its longest axis.
  [[nodiscard]] float mean_length() const { return mean_length_; }

 private:
  static constexpr std::size_t kSharing = 4;  // probes for each origin, on average; measured

  void sort_by_direction(std::span<const Probe> probes, std::size_t begin, std::size_t end) {
    constexpr std::size_t kWorthSorting = 32;
    if (end - begin < kWorthSorting) {
      for (std::size_t i = begin; i < end; ++i) order_[i] = static_cast<std::uint16_t>(i);
      return;
    }
    std::array<std::uint8_t, BoxScene::kMaxBatch> bin;
    std::array<std::uint16_t, kBins + 1> next{};
    for (std::size_t i = begin; i < end; ++i) {
      bin[i] = bin_of(probes[i].direction);
      ++next[bin[i] + 1U];
    }
    next[0] = static_cast<std::uint16_t>(begin);
    for (std::size_t b = 1; b <= kBins; ++b) next[b] = static_cast<std::uint16_t>(next[b] + next[b - 1]);
    for (std::size_t i = begin; i < end; ++i) order_[next[bin[i]]++] = static_cast<std::uint16_t>(i);
  }

  // Of a cube's six faces, cut into 4 x 4: the cell through which a direction points.
  static constexpr std::size_t kBins = 96;
  static std::uint8_t bin_of(const float (&d)[3]) {
    const float x = std::fabs(d[0]), y = std::fabs(d[1]), z = std::fabs(d[2]);
    const int axis = x >= y ? (x >= z ? 0 : 2) : (y >= z ? 1 : 2);
    const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    const float scale = 1.999F / std::max(std::fabs(d[axis]), 1e-18F);
    const auto cell = [&](float along) { return static_cast<int>(along * scale + 2.0F); };
    return static_cast<std::uint8_t>(((axis * 2 + (d[axis] < 0.0F ? 1 : 0)) * 4 + cell(d[u])) * 4 +
                                     cell(d[v]));
  }

  std::array<std::uint16_t, BoxScene::kMaxBatch> order_;
  float mean_length_ = 0.0F;
  bool share_origins_ = false;
};

}  // namespace frontlux::detail
