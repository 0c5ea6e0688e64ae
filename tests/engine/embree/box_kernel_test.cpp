// One box against packets of rays, by every instruction set of this processor, compared with exact slabs.

#include "embree/box_kernel.hpp"

#include "engine/embree/slab_oracle.hpp"
#include "support/random.hpp"

#include <gtest/gtest.h>

namespace frontlux::test {
namespace {

using detail::BoxKernel;
using detail::LocalBox;

constexpr float kTolerance = 1e-3F, kInfinity = std::numeric_limits<float>::infinity();
constexpr long double kSlack = 1e-4L;  // [voxels] the kernel's own rounding, with coordinates below 64

struct RayOfPacket {
  float origin[3], direction[3];
  float t_near, t_far;
  bool valid;
  [[nodiscard]] std::optional<long double> enters(const LocalBox& box, long double grown_by) const {
    return entry_time(box.center, box.half, grown_by, origin, direction, t_near, t_far);
  }
};

// Embree's layout: an array of `size` floats for each field of RTCRayN, and then of RTCHitN.
class Packet {
 public:
  enum Field : unsigned {
    kOrigin = 0,
    kNear = 3,
    kDirection = 4,
    kFar = 8,
    kId = 10,
    kPrimitive = 17,
    kGeometry = 18
  };
  static constexpr unsigned kFields = 20, kNothing = 77;

  explicit Packet(const std::vector<RayOfPacket>& rays)
      : size(static_cast<unsigned>(rays.size())), fields_(kFields * size) {
    for (unsigned i = 0; i < size; ++i) {
      for (unsigned a = 0; a < 3; ++a) {
        at(kOrigin + a, i) = rays[i].origin[a];
        at(kDirection + a, i) = rays[i].direction[a];
      }
      at(kNear, i) = rays[i].t_near;
      at(kFar, i) = rays[i].t_far;
      at(kId, i) = std::bit_cast<float>(id(i));
      at(kPrimitive, i) = at(kGeometry, i) = std::bit_cast<float>(kNothing);
      valid[i] = rays[i].valid ? -1 : 0;
    }
  }
  [[nodiscard]] unsigned id(unsigned ray) const { return size - 1 - ray; }
  float& at(unsigned field, unsigned ray) { return fields_[field * size + ray]; }
  [[nodiscard]] unsigned number(unsigned field, unsigned ray) {
    return std::bit_cast<unsigned>(at(field, ray));
  }
  float* data() { return fields_.data(); }

  unsigned size;
  std::array<int, 16> valid{};

 private:
  std::vector<float> fields_;
};

LocalBox random_box(Random& random) {
  LocalBox box{};
  for (unsigned i = 0; i < 3; ++i) {
    const int first = random.below(60) - 30, edge = 1 + random.below(random.one_in(2) ? 2 : 16);
    box.center[i] = static_cast<float>(first) + 0.5F * static_cast<float>(edge);
    box.half[i] = 0.5F * static_cast<float>(edge);
  }
  return box;
}

// Towards a point on the box's surface, inside it, or a few tolerances beside a face, an edge or a corner.
RayOfPacket random_ray(Random& random, const LocalBox& box) {
  RayOfPacket ray{{}, {}, 0.0F, kInfinity, !random.one_in(8)};
  const bool parallel = random.one_in(4);
  for (unsigned i = 0; i < 3; ++i) {
    const double beside = random.one_in(2) ? random.uniform(-3.0, 3.0) * kTolerance : 0.0;
    const double side = random.one_in(3) ? random.uniform(-1.0, 1.0) : random.one_in(2) ? 1.0 : -1.0;
    const double target = box.center[i] + side * box.half[i] + beside;
    ray.origin[i] = static_cast<float>(random.one_in(6) ? target : random.uniform(-32.0, 32.0));
    ray.direction[i] = static_cast<float>(target) - ray.origin[i];
    if (parallel && random.one_in(2)) {
      ray.origin[i] = static_cast<float>(target);
      ray.direction[i] = 0.0F;
    }
  }
  if (std::fabs(ray.direction[0]) + std::fabs(ray.direction[1]) + std::fabs(ray.direction[2]) < 0.1F)
    ray.direction[2] = 1.0F;  // a probe's direction is not zero
  if (random.one_in(3)) ray.t_far = static_cast<float>(random.uniform(0.0, 2.0));
  if (random.one_in(4)) ray.t_near = static_cast<float>(random.uniform(0.0, 1.5));
  ray.t_far = std::max(ray.t_near, ray.t_far);
  return ray;
}

// Calls check(kernel, box, rays, seen) for packets of every size that Embree makes.
template <class Check>
void with_packets(const Check& check) {
  ASSERT_FALSE(detail::box_kernels().empty());
  for (const BoxKernel& kernel : detail::box_kernels())
    for (const std::size_t size : {1U, 4U, 8U, 16U}) {
      SCOPED_TRACE(std::string(name_of(kernel.needs)) + ", packets of " + std::to_string(size));
      Random random(size);
      for (int round = 0; round < 3000; ++round) {
        const LocalBox box = random_box(random);
        std::vector<RayOfPacket> rays(size);
        for (RayOfPacket& ray : rays) ray = random_ray(random, box);
        check(kernel, box, rays);
        if (testing::Test::HasFailure()) return;
      }
    }
}

TEST(BoxKernel, OccludedIsSureOrSaysTooClose) {
  std::array<int, 3> seen{};  // sure, too close, neither
  with_packets([&](const BoxKernel& kernel, const LocalBox& box, const std::vector<RayOfPacket>& rays) {
    Packet packet(rays);
    std::array<std::uint8_t, 16> too_close{};
    kernel.occluded(box, kTolerance, packet.valid.data(), packet.data(), packet.size, too_close.data());
    for (unsigned i = 0; i < packet.size; ++i) {
      const RayOfPacket& ray = rays[i];
      const bool sure = packet.at(Packet::kFar, i) == -kInfinity, close = too_close[packet.id(i)] != 0;
      EXPECT_TRUE(sure || packet.at(Packet::kFar, i) == ray.t_far);
      if (!ray.valid) {
        EXPECT_FALSE(sure || close);
        continue;
      }
      EXPECT_FALSE(sure && close);
      EXPECT_TRUE(!sure || ray.enters(box, 0.0L));
      EXPECT_TRUE(sure || !ray.enters(box, -kTolerance - kSlack));
      EXPECT_TRUE(sure || close || !ray.enters(box, kTolerance - kSlack));
      EXPECT_TRUE(!(sure || close) || ray.enters(box, kTolerance + kSlack));
      ++seen[sure ? 0 : close ? 1 : 2];
    }
  });
  for (const int count : seen) EXPECT_GT(count, 1000);
}

TEST(BoxKernel, IntersectTakesTheEarliestTimeOfEntry) {
  std::array<int, 2> seen{};  // taken or not
  with_packets([&](const BoxKernel& kernel, const LocalBox& box, const std::vector<RayOfPacket>& rays) {
    Packet packet(rays);
    kernel.intersect(box, kTolerance, packet.valid.data(), packet.data(), packet.size, 5, 6);
    for (unsigned i = 0; i < packet.size; ++i) {
      const RayOfPacket& ray = rays[i];
      const bool taken = packet.number(Packet::kPrimitive, i) == 5;
      EXPECT_EQ(packet.number(Packet::kGeometry, i), taken ? 6U : Packet::kNothing);
      const float t = packet.at(Packet::kFar, i);
      if (!taken) {
        EXPECT_EQ(packet.number(Packet::kPrimitive, i), Packet::kNothing);
        EXPECT_EQ(t, ray.t_far);
      }
      const auto earliest = ray.enters(box, kTolerance + kSlack),
                 latest = ray.enters(box, kTolerance - kSlack);
      EXPECT_TRUE(!taken || (ray.valid && earliest && *earliest <= t && t < ray.t_far));
      if (ray.valid && latest && *latest < ray.t_far) {
        EXPECT_TRUE(taken);
        EXPECT_LE(t, *latest);
      }
      ++seen[taken ? 0 : 1];
    }
  });
  for (const int count : seen) EXPECT_GT(count, 1000);
}

}  // namespace
}  // namespace frontlux::test
