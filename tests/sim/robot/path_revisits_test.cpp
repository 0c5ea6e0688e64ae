#include "support/plain_revisits.hpp"
#include "support/random.hpp"

#include <frontlux/sim/path_revisits.hpp>

namespace frontlux::sim {
namespace {

using Eigen::Vector3d;
using Path = std::vector<Vector3d>;

double share_of(const Path& path) {
  PathRevisits revisits(path.front());
  for (const Vector3d& place : path) revisits.go_to(place);
  return revisits.share();
}

TEST(PathRevisits, OfKnownPaths) {
  const Vector3d start(-3.2, 1.7, 0.4);
  EXPECT_EQ(share_of({start}), 0.0);
  EXPECT_EQ(share_of({start, start, start}), 0.0) << "it only stood";
  EXPECT_EQ(share_of({start, start + Vector3d(80, 0, 0)}), 0.0) << "straight on";
  // There and back: a revisit from 2.5 m after the turn on, a metre from where it was 6 m before.
  EXPECT_NEAR(share_of({start, start + Vector3d(40, 0, 0), start}), (40.0 - 2.5) / 80.0, 0.003);
  // With a metre between, and with a little more.
  const auto beside = [&](double gap) {
    return Path{start, start + Vector3d(40, 0, 0), start + Vector3d(40, gap, 0), start + Vector3d(0, gap, 0)};
  };
  EXPECT_GT(share_of(beside(0.95)), 0.4);
  EXPECT_LT(share_of(beside(1.05)), 0.001);
  // Up a shaft and another one: height counts.
  EXPECT_EQ(
      share_of({start, start + Vector3d(20, 0, 0), start + Vector3d(20, 0, 3), start + Vector3d(0, 0, 3)}),
      0.0);
  // Twice around: all of the second round.
  Path square;
  for (int round = 0; round < 2; ++round)
    for (const Vector3d& corner : {Vector3d(0, 0, 0), {10, 0, 0}, {10, 10, 0}, {0, 10, 0}})
      square.push_back(start + corner);
  square.push_back(start);
  EXPECT_NEAR(share_of(square), 0.5, 0.02);
}

TEST(PathRevisits, AsByTheDefinitionOnRandomPaths) {
  for (std::uint64_t seed = 1; seed <= 15; ++seed) {
    test::Random random(seed);
    // Walks that cross cells on both sides of zero; some in steps of ticks, some between far viewpoints.
    const double reach = random.uniform(0.02, 2.5), edge = random.uniform(2.0, 15.0);
    Path path = {random.point(-edge, edge)};
    Vector3d towards = random.point(-edge, edge);
    for (int i = 0; i < 400; ++i) {
      const Vector3d way = towards - path.back();
      if (random.one_in(10) || way.norm() < reach) towards = random.point(-edge, edge);
      path.push_back(random.one_in(8) ? path.back() : Vector3d(path.back() + reach * way.normalized()));
    }
    EXPECT_NEAR(share_of(path), test::plain_revisited_part(path), 1e-9) << "seed " << seed;
  }
}

TEST(PathRevisits, AsByTheDefinitionOnALattice) {
  // Places exactly a metre apart, and cells' faces.
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    test::Random random(seed);
    Path path = {Vector3d::Zero()};
    for (int i = 0; i < 120; ++i) {
      Vector3d step = Vector3d::Zero();
      step[random.below(3)] = random.one_in(2) ? 1.0 : -1.0;
      path.push_back(path.back() + step);
    }
    EXPECT_NEAR(share_of(path), test::plain_revisited_part(path), 0.01) << "seed " << seed;
  }
}

}  // namespace
}  // namespace frontlux::sim
