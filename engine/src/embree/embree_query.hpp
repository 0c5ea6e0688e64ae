#pragma once

#include "embree/box_scene.hpp"

#if FRONTLUX_EMBREE == 3
#include <embree3/rtcore.h>
#else
#include <embree4/rtcore.h>
#endif

#include <algorithm>
#include <cstddef>
#include <cstdint>

/// How Embree 3.13 and 4 are asked, one ray or a packet at a time. Neither's streams are used: 4 has none.
namespace frontlux::detail {

/// What a query hands to the callbacks.
struct QueryContext {
#if FRONTLUX_EMBREE == 3
  RTCIntersectContext embree;
#else
  RTCRayQueryContext embree;
#endif
  std::uint8_t* too_close = nullptr;
};

/// Embree's types and calls for packets of one size.
template <unsigned kSize>
struct Packet;
#define FRONTLUX_PACKET(SIZE)                               \
  template <>                                               \
  struct Packet<SIZE> {                                     \
    using Rays = RTCRay##SIZE;                              \
    using RayHits = RTCRayHit##SIZE;                        \
    static constexpr auto kOccluded = &rtcOccluded##SIZE;   \
    static constexpr auto kIntersect = &rtcIntersect##SIZE; \
  };
FRONTLUX_PACKET(4)
FRONTLUX_PACKET(8)
FRONTLUX_PACKET(16)
#undef FRONTLUX_PACKET

template <class Rays>
void set_ray(Rays& rays, unsigned lane, const Probe& probe, std::size_t id) {
  rays.org_x[lane] = probe.origin[0];
  rays.org_y[lane] = probe.origin[1];
  rays.org_z[lane] = probe.origin[2];
  rays.tnear[lane] = probe.t_near;
  rays.dir_x[lane] = probe.direction[0];
  rays.dir_y[lane] = probe.direction[1];
  rays.dir_z[lane] = probe.direction[2];
  rays.time[lane] = 0.0F;
  rays.tfar[lane] = probe.t_far;
  rays.mask[lane] = ~0U;
  rays.id[lane] = static_cast<unsigned>(id);
  rays.flags[lane] = 0;
}

inline RTCRay make_ray(const Probe& probe, std::size_t id) {
  const auto& [x, y, z] = probe.origin;
  const auto& [dx, dy, dz] = probe.direction;
  return {x, y, z, probe.t_near, dx, dy, dz, 0.0F, probe.t_far, ~0U, static_cast<unsigned>(id), 0};
}

/// A scene with what belongs to each question.
class EmbreeQuery {
 public:
  EmbreeQuery(RTCScene scene, bool coherent, std::uint8_t* too_close) : scene_(scene) {
    context_.too_close = too_close;
#if FRONTLUX_EMBREE == 3
    rtcInitIntersectContext(&context_.embree);
    if (coherent) context_.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
#else
    rtcInitRayQueryContext(&context_.embree);
    rtcInitOccludedArguments(&occluded_);
    rtcInitIntersectArguments(&intersect_);
    occluded_.context = intersect_.context = &context_.embree;
    if (coherent) occluded_.flags = intersect_.flags = RTC_RAY_QUERY_FLAG_COHERENT;
#endif
  }

#if FRONTLUX_EMBREE == 3
  void occluded(RTCRay& ray) { rtcOccluded1(scene_, &context_.embree, &ray); }
  void intersect(RTCRayHit& ray) { rtcIntersect1(scene_, &context_.embree, &ray); }
  template <unsigned kSize>
  void occluded(const int* valid, typename Packet<kSize>::Rays& rays) {
    Packet<kSize>::kOccluded(valid, scene_, &context_.embree, &rays);
  }
  template <unsigned kSize>
  void intersect(const int* valid, typename Packet<kSize>::RayHits& rays) {
    Packet<kSize>::kIntersect(valid, scene_, &context_.embree, &rays);
  }
#else
  void occluded(RTCRay& ray) { rtcOccluded1(scene_, &ray, &occluded_); }
  void intersect(RTCRayHit& ray) { rtcIntersect1(scene_, &ray, &intersect_); }
  template <unsigned kSize>
  void occluded(const int* valid, typename Packet<kSize>::Rays& rays) {
    Packet<kSize>::kOccluded(valid, scene_, &rays, &occluded_);
  }
  template <unsigned kSize>
  void intersect(const int* valid, typename Packet<kSize>::RayHits& rays) {
    Packet<kSize>::kIntersect(valid, scene_, &rays, &intersect_);
  }
#endif

 private:
  RTCScene scene_;
  QueryContext context_;
#if FRONTLUX_EMBREE != 3
  RTCOccludedArguments occluded_;
  RTCIntersectArguments intersect_;
#endif
};

/// Calls visit(first, count, valid) for packets of probes, the last of them perhaps not full.
template <unsigned kSize, class Visit>
void for_each_packet(std::size_t size, const Visit& visit) {
  for (std::size_t first = 0; first < size; first += kSize) {
    const auto count = static_cast<unsigned>(std::min<std::size_t>(kSize, size - first));
    alignas(64) int valid[kSize];
    for (unsigned lane = 0; lane < kSize; ++lane) valid[lane] = lane < count ? -1 : 0;
    visit(first, count, valid);
  }
}

}  // namespace frontlux::detail
