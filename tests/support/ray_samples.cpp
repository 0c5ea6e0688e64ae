#include "support/ray_samples.hpp"

#include "support/random.hpp"

namespace frontlux::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                kInfinity = std::numeric_limits<float>::infinity();

class Sampler {
 public:
  Sampler(const VoxelGrid& grid, std::uint64_t seed) : grid_(grid), random_(seed) {
    // The part that is mapped in detail: some trees also hold a few voxels kilometres away.
    grid.for_each_block([&](const Block& block, const Brick* brick, Occupancy state) {
      if (brick != nullptr || (state == Occupancy::kFree && block.log2_edge <= 6)) blocks_.push_back(block);
    });
    if (blocks_.empty()) blocks_.push_back({{32768, 32768, 32768}, 3});
  }

  Random& random() { return random_; }

  VoxelKey any_key() {
    const Block& block = random_.pick(blocks_);
    return random_.key_in(grown(cube(block.corner, 1 << block.log2_edge), 2));
  }
  VoxelKey free_key() {
    for (int attempt = 0; attempt < 64; ++attempt) {
      const VoxelKey key = any_key();
      if (grid_.at(key) == Occupancy::kFree) return key;
    }
    return any_key();
  }
  VoxelKey mostly_free_key() { return random_.one_in(8) ? any_key() : free_key(); }

  // A point of a voxel along one axis, in half edges from its lower face: 0 face, 1 centre, 2 upper face; or
  // anywhere.
  float along(std::uint16_t key, int half_edges) {
    const double low = (static_cast<int>(key) - Lattice::kOrigin) * grid_.resolution();
    if (std::abs(key - Lattice::kOrigin) <= 1 &&
        random_.one_in(4))  // around 0, where floats lie close together
      return static_cast<float>(
          std::ldexp(random_.uniform(-1.0, 1.0) * grid_.resolution(), -random_.below(150)));
    if (low != 0.0 && random_.one_in(20))  // on either side of which they have other spaces
      return static_cast<float>(std::copysign(std::exp2(std::floor(std::log2(std::fabs(low)))), low));
    if (half_edges == 1) return static_cast<float>(grid_.lattice().center(key));
    double offset = half_edges >= 0 ? half_edges * 0.5 : random_.uniform(0.0, 1.0);
    if (random_.one_in(6))
      offset += std::ldexp(random_.uniform(-1.0, 1.0), -random_.below(30));  // all but there
    return static_cast<float>(low + offset * grid_.resolution());
  }
  Eigen::Vector3f point_in(const VoxelKey& key) {
    switch (random_.below(4)) {
      case 0:
        return grid_.lattice().center(key);
      case 1:
        return {along(key.x, random_.below(3)), along(key.y, random_.below(3)),
                along(key.z, random_.below(3))};
      case 2:
        return {along(key.x, random_.below(3)), along(key.y, -1), along(key.z, -1)};
      default:
        return {along(key.x, -1), along(key.y, -1), along(key.z, -1)};
    }
  }

  Eigen::Vector3f origin() {
    if (random_.one_in(400)) {
      const float edge = static_cast<float>(32768.0 * grid_.resolution());
      const float odd[] = {kNan, kInfinity, -kInfinity, 1e30F, edge, -edge, std::nextafter(edge, 0.0F),
                           -0.0F};
      Eigen::Vector3f p = point_in(any_key());
      p[random_.below(3)] = odd[random_.below(8)];
      return p;
    }
    if (random_.one_in(100)) {  // far outside everything mapped
      const double reach = 32768.0 * grid_.resolution();
      return random_.point(-reach, reach).cast<float>();
    }
    return point_in(mostly_free_key());
  }

  Eigen::Vector3f direction(const Eigen::Vector3f& origin) {
    const auto sign = [&] { return static_cast<float>(random_.below(3) - 1); };
    const auto at_random = [&] { return static_cast<float>(random_.uniform(-1.0, 1.0)); };
    const auto tiny = [&] {
      return static_cast<float>(
          std::ldexp(random_.uniform(-1.0, 1.0), -random_.below(random_.one_in(3) ? 150 : 32)));
    };
    const auto drawn = [&]() -> Eigen::Vector3f {
      switch (random_.below(12)) {
        case 0:  // axes, diagonals, zero
          return {sign(), sign(), sign()};
        case 1:
          return Eigen::Vector3f::Unit(random_.below(3)) * at_random();
        case 2:  // through lattice points
          return {sign() * 2.0F, sign(), sign() * 3.0F};
        case 3:  // all but parallel to a face
          return {sign(), sign(), tiny()};
        case 4:
          return {at_random(), tiny(), sign()};
        case 10:
          return {tiny(), tiny(), sign()};
        case 11:
          return {sign(), tiny(), at_random()};
        case 5:
        case 6:  // to corners, edges, centres
          return point_in(any_key()) - origin;
        default:
          return {at_random(), at_random(), at_random()};
      }
    };
    Eigen::Vector3f d = drawn();
    if (random_.one_in(20))
      d *= std::ldexp(1.0F, random_.below(250) - 130);  // overflows and denormals among them
    if (random_.one_in(300)) {
      constexpr float kOdd[] = {kNan, kInfinity, std::numeric_limits<float>::denorm_min(), -0.0F};
      d[random_.below(3)] = kOdd[random_.below(4)];
    }
    return d;
  }

  // Of a ray: at, or right beside, the distance of a centre near its line.
  double range_to_center(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) {
    const Lattice& lattice = grid_.lattice();
    const double far = random_.uniform(0.0, 60.0) * grid_.resolution();
    const auto key = lattice.key(origin + (static_cast<float>(far) * direction.normalized()).eval());
    if (!key) return range();
    double squared = 0.0;
    for (int i = 0; i < 3; ++i) {
      const float off = lattice.center(*key)[i] - origin[i];
      squared += static_cast<double>(off * off);
    }
    return std::sqrt(squared) * (1.0 + random_.below(9) * 0x1p-26 - 0x1p-24);
  }

  double range() {
    const double voxel = grid_.resolution();
    switch (random_.below(12)) {
      case 0:
        return random_.uniform(0.0, 2.0) * voxel;
      case 1:
        return random_.below(20) * voxel;  // exactly at centres of voxels along an axis
      case 2:
        return (random_.below(20) + 0.5) * voxel;
      case 3:
        return random_.uniform(0.0, 1e4) * voxel;
      case 4: {
        const double odd[] = {1e-300, 1e300, std::numeric_limits<double>::infinity(), 1e-9, -0.0};
        if (!random_.one_in(100)) return 30.0 * voxel;
        return odd[random_.below(5)];
      }
      default:
        return random_.uniform(0.0, 100.0) * voxel;
    }
  }

 private:
  const VoxelGrid& grid_;
  Random random_;
  std::vector<Block> blocks_;
};

}  // namespace

std::vector<Ray> adversarial_rays(const VoxelGrid& grid, std::size_t count, std::uint64_t seed) {
  Sampler sample(grid, seed);
  std::vector<Ray> rays(count);
  for (Ray& ray : rays) {
    ray.origin = sample.origin();
    ray.direction = sample.direction(ray.origin);
    ray.max_range = sample.random().one_in(500) ? -1.0
                    : sample.random().one_in(5) ? sample.range_to_center(ray.origin, ray.direction)
                                                : sample.range();
  }
  return rays;
}

std::vector<KeySegment> adversarial_key_segments(const VoxelGrid& grid, std::size_t count,
                                                 std::uint64_t seed) {
  Sampler sample(grid, seed);
  std::vector<KeySegment> segments(count);
  for (KeySegment& segment : segments) {
    segment.from = sample.mostly_free_key();
    if (sample.random().one_in(4)) {
      segment.to = sample.any_key();
      continue;
    }
    const int reach = 1 << (1 + sample.random().below(7));
    const int length = sample.random().below(reach);
    const bool on_diagonal = sample.random().one_in(5);
    const auto along = [&](std::uint16_t from) {
      const int step = on_diagonal ? length * (sample.random().below(3) - 1)
                                   : sample.random().below(2 * reach + 1) - reach;
      return static_cast<std::uint16_t>(std::clamp(from + step, 0, 65535));
    };
    segment.to = {along(segment.from.x), along(segment.from.y), along(segment.from.z)};
  }
  return segments;
}

std::vector<Segment> adversarial_segments(const VoxelGrid& grid, std::size_t count, std::uint64_t seed) {
  Sampler sample(grid, seed ^ 0x5EED);
  std::vector<Segment> segments(count);
  const auto keys = adversarial_key_segments(grid, count, seed);
  for (std::size_t i = 0; i < count; ++i) {
    segments[i] = {sample.point_in(keys[i].from), sample.point_in(keys[i].to)};
    if (sample.random().one_in(200)) segments[i].from = sample.origin();
    if (sample.random().one_in(200)) segments[i].to = sample.origin();
  }
  return segments;
}

}  // namespace frontlux::test
