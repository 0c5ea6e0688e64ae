#pragma once

#include <frontlux/ray_caster.hpp>

#include <atomic>
#include <cstdint>

namespace frontlux::planner::detail {

/// Casts with another caster, and counts the segments whose visibility it is asked for.
class CountingRayCaster final : public RayCaster {
 public:
  /// @param counted  has to outlive this
  CountingRayCaster(const RayCaster& counted, const Lattice& lattice)
      : RayCaster(lattice), counted_(counted) {}

  [[nodiscard]] std::uint64_t rays() const { return rays_; }

 private:
  void do_visible(std::span<const KeySegment> segments, std::span<std::uint8_t> visible,
                  UnknownPolicy unknown) const override {
    rays_.fetch_add(segments.size(), std::memory_order_relaxed);
    counted_.visible(segments, visible, unknown);
  }
  void do_visible(std::span<const Segment> segments, std::span<std::uint8_t> visible,
                  UnknownPolicy unknown) const override {
    rays_.fetch_add(segments.size(), std::memory_order_relaxed);
    counted_.visible(segments, visible, unknown);
  }
  void do_cast(std::span<const Ray> rays, std::span<Hit> hits, UnknownPolicy unknown) const override {
    counted_.cast(rays, hits, unknown);
  }
  void do_count(std::span<const Ray> rays, std::span<PathCount> counts,
                UnknownPolicy unknown) const override {
    counted_.count(rays, counts, unknown);
  }
  void do_count(std::span<const Segment> segments, std::span<PathCount> counts,
                UnknownPolicy unknown) const override {
    counted_.count(segments, counts, unknown);
  }
  void do_count(std::span<const KeySegment> segments, std::span<PathCount> counts,
                UnknownPolicy unknown) const override {
    counted_.count(segments, counts, unknown);
  }
  void do_update(const VoxelGrid&) override {}  // the counted caster holds the map, and its owner updates it

  const RayCaster& counted_;
  mutable std::atomic<std::uint64_t> rays_{0};
};

}  // namespace frontlux::planner::detail
