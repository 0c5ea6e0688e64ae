#include "packet/single_walk.hpp"

#include "isa/targets.hpp"
#include "packet/packet_walk.hpp"
#include "packet/start_on_faces.hpp"
#include "walk/walk.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace frontlux::detail {
namespace {

constexpr std::array kLowBit = {0U, 3U, 6U};  // of each axis in an index

// A number for each axis, and a fourth one that means nothing. Times are whole numbers, as in packets.
using PerAxis [[gnu::vector_size(16)]] = std::int32_t;
// The end of a ray's time. Four crossings behind it still fit into 31 bits, though their times mean nothing.
constexpr std::int32_t kEndOfTime = (1 << 28) - 1;
constexpr std::int32_t kNever = 7 * (1 << 28);         // later than those, and `too_close` can be added
constexpr std::uint32_t kWalksOn = kFirstWalkEnd - 1;  // that of a ray which has not ended yet

// When a ray crosses into the next voxel along each axis for the first time, and the time between two such
// crossings. They come from the direction as it is given, since castRay's own, of length 1 in float, is known
// later.
struct Times {
  PerAxis first, between;

  // As the function of that name.
  bool cross_at_start(const OpenVoxels& table, std::uint32_t& index, std::uint32_t flip, int too_close) {
    std::array next = {first[0], first[1], first[2]};
    if (!detail::cross_at_start(table, next, {between[0], between[1], between[2]}, index, flip, too_close))
      return false;
    first = PerAxis{next[0], next[1], next[2], kNever};
    return true;
  }
};
// Those are off by 2^-24, two of them together by 32 at the end of time. All are cut off to whole numbers,
// and so is what each step adds: after n steps along an axis the difference of two is off by n + 1 more.
constexpr int kRounding = 40;

// Along castRay's own times.
// @return what `LoneWalk::stopped_at` is
std::uint32_t walk_exactly(const OpenVoxels& table, Crossings<double> line, std::uint32_t index,
                           std::uint32_t flip, double length) {
  std::array<double, 3>& t = line.t_max;
  while (true) {
    // Ties go to z before y before x (rule 5).
    const std::size_t across = t[0] < t[1] ? 0 : 1, axis = t[across] < t[2] ? across : 2;
    if (t[axis] > length) return kWentThrough;
    t[axis] += line.t_delta[axis];
    index = advanced(index, table.layout().bits[axis], 1);
    if (!table.open(index ^ flip)) return index ^ flip;
  }
}

#ifdef FRONTLUX_X86_SETS
FRONTLUX_BEGIN_AVX2
namespace avx2 {

// As below, for all axes at once.
inline Times times_of(const Lattice& lattice, const Ray& ray, const Eigen::Vector3f& direction,
                      double units) {
  const auto all = [](const Eigen::Vector3f& v) { return _mm_setr_ps(v.x(), v.y(), v.z(), 0.0F); };
  const __m256d resolution = _mm256_set1_pd(lattice.resolution()), half = _mm256_set1_pd(0.5);
  const __m256d origin = _mm256_cvtps_pd(all(ray.origin)), d = _mm256_cvtps_pd(all(ray.direction));
  const __m256d cell = _mm256_floor_pd(_mm256_mul_pd(origin, _mm256_set1_pd(lattice.voxels_per_metre())));
  const __m256d sign = _mm256_and_pd(d, _mm256_set1_pd(-0.0));
  const __m256d border = _mm256_add_pd(_mm256_mul_pd(_mm256_add_pd(cell, half), resolution),
                                       _mm256_xor_pd(_mm256_mul_pd(resolution, half), sign));
  const __m256d ahead = _mm256_xor_pd(_mm256_sub_pd(border, origin), sign);
  const __m256d per_metre =
      _mm256_mul_pd(_mm256_set1_pd(units), _mm256_div_pd(_mm256_set1_pd(1.0), _mm256_xor_pd(d, sign)));
  // What is not a number becomes the second of two.
  const __m256d first = _mm256_max_pd(_mm256_min_pd(_mm256_mul_pd(ahead, per_metre), _mm256_set1_pd(kNever)),
                                      _mm256_set1_pd(-1.0));
  const __m256d between =
      _mm256_min_pd(_mm256_mul_pd(resolution, per_metre), _mm256_set1_pd(kEndOfTime + 1.0));
  const __m128 stands_still = _mm_cmpeq_ps(all(direction), _mm_setzero_ps());
  const __m128i t =
      _mm_blendv_epi8(_mm256_cvttpd_epi32(first), _mm_set1_epi32(kNever), _mm_castps_si128(stands_still));
  return {std::bit_cast<PerAxis>(t), std::bit_cast<PerAxis>(_mm256_cvttpd_epi32(between))};
}

#include "packet/single_walk_body.inl"

}  // namespace avx2
FRONTLUX_END_TARGET

FRONTLUX_BEGIN_AVX512
namespace avx512 {
using avx2::times_of;

#include "packet/single_walk_body.inl"
#include "packet/single_walk_columns.inl"

}  // namespace avx512
FRONTLUX_END_TARGET
#endif

namespace plain {

// @param ray        starts in the key range
// @param direction  as `normalized_as_octomap` returns it
// @param units      of time in which the ray, in its given direction, goes a metre
inline Times times_of(const Lattice& lattice, const Ray& ray, const Eigen::Vector3f& direction,
                      double units) {
  const double resolution = lattice.resolution(), half = resolution * 0.5;
  Times times{{kNever, kNever, kNever, kNever}, {}};
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<int>(a);
    const double o = static_cast<double>(ray.origin[axis]), d = static_cast<double>(ray.direction[axis]);
    const double middle = lattice.center(*lattice.key(o));
    const double ahead = d < 0.0 ? o - (middle - half) : middle + half - o;
    const double per_metre = units * (1.0 / std::fabs(d));
    const double first = ahead * per_metre, between = resolution * per_metre;
    if (direction[axis] != 0.0F)
      times.first[a] = static_cast<std::int32_t>(std::clamp(first, -1.0, double{kNever}));
    times.between[a] = static_cast<std::int32_t>(std::min(between, kEndOfTime + 1.0));
  }
  return times;
}

#include "packet/single_walk_body.inl"

}  // namespace plain
}  // namespace

#ifdef FRONTLUX_X86_SETS
LoneWalk walk_alone_by_avx512(const Lattice& lattice, const OpenVoxels& table, const Ray& ray) {
  return avx512::walk_alone<avx512::Columns>(lattice, table, ray);
}
LoneWalk walk_alone_by_avx2(const Lattice& lattice, const OpenVoxels& table, const Ray& ray) {
  return avx2::walk_alone<avx2::Steps>(lattice, table, ray);
}
#endif
LoneWalk walk_alone(const Lattice& lattice, const OpenVoxels& table, const Ray& ray) {
  return plain::walk_alone<plain::Steps>(lattice, table, ray);
}

}  // namespace frontlux::detail
