#include "embree/box_kernel.hpp"

#include "isa/targets.hpp"

#include <cmath>
#include <limits>

namespace frontlux::detail {
namespace {

// Fields of Embree's RTCRayN and, after it, RTCHitN.
enum Field : unsigned {
  kOrigin = 0,
  kNear = 3,
  kDirection = 4,
  kFar = 8,
  kId = 10,
  kPrimitive = 17,
  kGeometry = 18
};

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// When a ray is inside a box, and by how much that can be wrong, along one axis.
struct Slab {
  float center, half, error;  // times
};

[[gnu::always_inline]] inline Slab cross(const LocalBox& box, int axis, float tolerance, float origin,
                                         float direction) {
  // Keeps the inverse finite: 0 * infinity has no answer.
  const float d = std::fabs(direction) < 1e-18F ? 1e-18F : direction;
  const float inverse = 1.0F / d, span = std::fabs(inverse);
  return {(box.center[axis] - origin) * inverse, box.half[axis] * span, tolerance * span};
}

[[gnu::always_inline]] inline float max3(float a, float b, float c) {
  const float ab = a > b ? a : b;
  return ab > c ? ab : c;
}
[[gnu::always_inline]] inline float min3(float a, float b, float c) {
  const float ab = a < b ? a : b;
  return ab < c ? ab : c;
}

// When a ray enters and leaves the box, grown and shrunk by what can be wrong.
struct Passage {
  float grown_in, grown_out, shrunk_in, shrunk_out;
};

template <class Field>
[[gnu::always_inline]] inline Passage pass(const LocalBox& box, float tolerance, const Field& field,
                                           unsigned lane) {
  const Slab x = cross(box, 0, tolerance, field(kOrigin, lane), field(kDirection, lane));
  const Slab y = cross(box, 1, tolerance, field(kOrigin + 1, lane), field(kDirection + 1, lane));
  const Slab z = cross(box, 2, tolerance, field(kOrigin + 2, lane), field(kDirection + 2, lane));
  return {max3(x.center - x.half - x.error, y.center - y.half - y.error, z.center - z.half - z.error),
          min3(x.center + x.half + x.error, y.center + y.half + y.error, z.center + z.half + z.error),
          max3(x.center - x.half + x.error, y.center - y.half + y.error, z.center - z.half + z.error),
          min3(x.center + x.half - x.error, y.center + y.half - y.error, z.center + z.half - z.error)};
}

template <unsigned kSize>
[[gnu::always_inline]] inline void occluded_packet(const LocalBox& box, float tolerance,
                                                   const int* __restrict valid, float* __restrict rays,
                                                   std::uint8_t* too_close) {
  const auto field = [rays](unsigned f, unsigned lane) { return rays[f * kSize + lane]; };
  alignas(64) int sure[kSize], near[kSize];
  int any_near = 0;
  for (unsigned i = 0; i < kSize; ++i) {
    const Passage p = pass(box, tolerance, field, i);
    const float t_near = field(kNear, i), t_far = field(kFar, i);
    const int grown = static_cast<int>(p.grown_in <= p.grown_out) & static_cast<int>(p.grown_in <= t_far) &
                      static_cast<int>(p.grown_out >= t_near) & static_cast<int>(valid[i] != 0);
    sure[i] = static_cast<int>(p.shrunk_in <= p.shrunk_out) & static_cast<int>(p.shrunk_in <= t_far) &
              static_cast<int>(p.shrunk_out >= t_near) & grown;
    near[i] = grown & ~sure[i];
    any_near |= near[i];
  }
  for (unsigned i = 0; i < kSize; ++i)
    rays[kFar * kSize + i] = sure[i] != 0 ? -kInfinity : rays[kFar * kSize + i];
  if (any_near == 0) return;
  const auto* ids = reinterpret_cast<const std::uint32_t*>(rays + kId * kSize);
  for (unsigned i = 0; i < kSize; ++i)
    if (near[i] != 0) too_close[ids[i]] = 1;
}

template <unsigned kSize>
[[gnu::always_inline]] inline void intersect_packet(const LocalBox& box, float tolerance,
                                                    const int* __restrict valid, float* __restrict ray_hits,
                                                    unsigned primitive, unsigned geometry) {
  const auto field = [ray_hits](unsigned f, unsigned lane) { return ray_hits[f * kSize + lane]; };
  auto* ids = reinterpret_cast<std::uint32_t*>(ray_hits);
  for (unsigned i = 0; i < kSize; ++i) {
    const Passage p = pass(box, tolerance, field, i);
    const float t_near = field(kNear, i), t_far = field(kFar, i);
    const float t = p.grown_in > t_near ? p.grown_in : t_near;
    const bool take =
        static_cast<bool>(static_cast<int>(p.grown_in <= p.grown_out) & static_cast<int>(t < t_far) &
                          static_cast<int>(p.grown_out >= t_near) & static_cast<int>(valid[i] != 0));
    ray_hits[kFar * kSize + i] = take ? t : t_far;
    ids[kPrimitive * kSize + i] = take ? primitive : ids[kPrimitive * kSize + i];
    ids[kGeometry * kSize + i] = take ? geometry : ids[kGeometry * kSize + i];
  }
}

// One body, compiled for each instruction set: the functions above are inlined into it and vectorised there.
#define FRONTLUX_BOX_KERNEL(NAME)                                                                          \
  void NAME##_occluded(const LocalBox& box, float tolerance, const int* valid, float* rays, unsigned size, \
                       std::uint8_t* too_close) {                                                          \
    if (size == 16) return occluded_packet<16>(box, tolerance, valid, rays, too_close);                    \
    if (size == 8) return occluded_packet<8>(box, tolerance, valid, rays, too_close);                      \
    if (size == 4) return occluded_packet<4>(box, tolerance, valid, rays, too_close);                      \
    occluded_packet<1>(box, tolerance, valid, rays, too_close);                                            \
  }                                                                                                        \
  void NAME##_intersect(const LocalBox& box, float tolerance, const int* valid, float* ray_hits,           \
                        unsigned size, unsigned primitive, unsigned geometry) {                            \
    if (size == 16) return intersect_packet<16>(box, tolerance, valid, ray_hits, primitive, geometry);     \
    if (size == 8) return intersect_packet<8>(box, tolerance, valid, ray_hits, primitive, geometry);       \
    if (size == 4) return intersect_packet<4>(box, tolerance, valid, ray_hits, primitive, geometry);       \
    intersect_packet<1>(box, tolerance, valid, ray_hits, primitive, geometry);                             \
  }

FRONTLUX_BOX_KERNEL(none)
#ifdef FRONTLUX_X86_SETS
FRONTLUX_BEGIN_AVX512
FRONTLUX_BOX_KERNEL(avx512)
FRONTLUX_END_TARGET
FRONTLUX_BEGIN_AVX2
FRONTLUX_BOX_KERNEL(avx2)
FRONTLUX_END_TARGET
#endif
#undef FRONTLUX_BOX_KERNEL

constexpr BoxKernel kKernels[] = {
#ifdef FRONTLUX_X86_SETS
    {InstructionSet::kAvx512, &avx512_occluded, &avx512_intersect},
    {InstructionSet::kAvx2, &avx2_occluded, &avx2_intersect},
#endif
    {InstructionSet::kNone, &none_occluded, &none_intersect}};

}  // namespace

std::span<const BoxKernel> box_kernels() { return runnable(std::span<const BoxKernel>(kKernels)); }

const BoxKernel& box_kernel() {
  static const BoxKernel& kernel = box_kernels().front();
  return kernel;
}

}  // namespace frontlux::detail
