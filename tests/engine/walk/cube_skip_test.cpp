// skip_cube against the loops that it replaces: additions one by one, steps one by one.

#include "walk/cube_skip.hpp"

#include "support/random.hpp"

#include <frontlux/lattice.hpp>

namespace frontlux::test {
namespace {

void expect_additions_as_in_a_loop(double t, double delta, int count) {
  double expected = t;
  for (int i = 0; i < count; ++i) expected += delta;
  ASSERT_EQ(std::bit_cast<std::uint64_t>(detail::after_additions(t, delta, count)),
            std::bit_cast<std::uint64_t>(expected))
      << std::hexfloat << t << " + " << count << " * " << delta;
}

TEST(CubeSkip, AdditionsRoundAsALoopRounds) {
  Random random(5);
  for (int round = 0; round < 60'000; ++round) {
    const double delta = std::ldexp(random.uniform(0.5, 1.0), random.below(20) - 8);
    double t = delta * random.uniform(0.0, 1.0);
    switch (random.below(6)) {
      case 0:
        t = -t * 1e-9;  // an origin on a face
        break;
      case 1:
        t = std::ldexp(random.uniform(0.5, 1.0), random.below(24) - 8);
        break;
      case 2:
        t = 0.0;
        break;
      case 3:
        t = std::nextafter(std::ldexp(1.0, random.below(20)), random.one_in(2) ? 0.0 : 1e9);
        break;
    }
    expect_additions_as_in_a_loop(t, delta, random.below(1 << random.below(14)));
    if (HasFatalFailure()) return;
  }
}

// Increments of k + 1/2 units: every addition is a tie, broken towards even.
TEST(CubeSkip, AdditionsBreakTiesAsALoopDoes) {
  Random random(6);
  for (int round = 0; round < 20'000; ++round) {
    const int exponent = random.below(8);
    const double unit = std::ldexp(1.0, exponent - 52);
    const double t = std::ldexp(1.0, exponent) + random.below(64) * unit;
    const double delta = (random.below(1 << random.below(30)) + 0.5) * unit;
    expect_additions_as_in_a_loop(t, delta, random.below(3000));
    if (HasFatalFailure()) return;
  }
}

TEST(CubeSkip, AdditionsAtTheLimitsOfDouble) {
  const double max = std::numeric_limits<double>::max(), infinity = std::numeric_limits<double>::infinity(),
               least = std::numeric_limits<double>::denorm_min();
  for (const double t : {0.0, least, -least, 1e-310, 1.0, 1e299, 1e307, max, infinity})
    for (const double delta : {0.0, least, 1e-310, 1e-20, 1.0, 1e292, 1e306, max, infinity})
      for (const int count : {0, 1, 2, 3, 4, 5, 100, 5000}) expect_additions_as_in_a_loop(t, delta, count);
}

template <class Time>
struct Stepped {
  detail::PathState<Time> at;
  bool overstepped = false;
  Time last{};
};

// The same way by single steps, with rule 5 written out.
template <class Time>
Stepped<Time> step_out_of_cube(detail::PathState<Time> at, int log2_edge) {
  const auto cube = [&](const std::array<int, 3>& key) {
    return std::array{key[0] >> log2_edge, key[1] >> log2_edge, key[2] >> log2_edge};
  };
  auto key = detail::as_array(at.key);
  const auto home = cube(key);
  while (true) {
    const auto& t = at.line.t_max;
    const std::size_t axis = t[0] < t[1] && t[0] < t[2] ? 0 : t[1] <= t[0] && t[1] < t[2] ? 1 : 2;
    const Time time = t[axis];
    at.line.t_max[axis] += at.line.t_delta[axis];
    if (--at.steps_left[axis] < 0) return {at, true, time};
    key[axis] += at.line.step[axis];
    at.key = detail::as_key(key);
    if (cube(key) != home) return {at, false, time};
  }
}

template <class Time>
void expect_same_skip(const detail::PathState<Time>& from, int log2_edge) {
  const Stepped<Time> expected = step_out_of_cube(from, log2_edge);
  detail::PathState<Time> at = from;
  const detail::CubeSkip skip = detail::skip_cube(at, log2_edge, std::numeric_limits<Time>::max());
  ASSERT_EQ(skip, expected.overstepped ? detail::CubeSkip::kOverstep : detail::CubeSkip::kSkipped);
  ASSERT_EQ(at.steps_left, expected.at.steps_left);
  if (!expected.overstepped) {
    ASSERT_EQ(at.key, expected.at.key);
    ASSERT_EQ(at.line.t_max, expected.at.line.t_max);
  }
  // Not if it ends at the limit.
  at = from;
  ASSERT_EQ(detail::skip_cube(at, log2_edge, expected.last), detail::CubeSkip::kNone);
  ASSERT_EQ(at.key, from.key);
  ASSERT_EQ(at.line.t_max, from.line.t_max);
  ASSERT_EQ(at.steps_left, from.steps_left);
}

TEST(CubeSkip, EndsWhereSingleStepsEnd) {
  Random random(7);
  const Lattice lattice(0.1);
  for (int round = 0; round < 20'000; ++round) {
    const VoxelKey start = random.key_in(kAllVoxels);
    Eigen::Vector3f origin = lattice.center(start), direction;
    for (int i = 0; i < 3; ++i) {
      if (random.one_in(3)) origin[i] += static_cast<float>(random.uniform(-0.04, 0.04));
      // Diagonals, axes, and lines almost parallel to a face.
      direction[i] = random.one_in(3)
                         ? static_cast<float>(random.below(3) - 1)
                         : static_cast<float>(std::ldexp(random.uniform(-1, 1), -random.below(20)));
    }
    if (lattice.key(origin) != start) continue;
    const auto line = detail::crossings_of(lattice, origin, start, detail::normalized_as_octomap(direction));
    if (line.none()) continue;
    std::array<int, 3> steps = detail::as_array(start);
    for (std::size_t i = 0; i < 3; ++i) {
      if (line.step[i] > 0) steps[i] = Lattice::kKeysPerAxis - 1 - steps[i];
      if (random.one_in(5)) steps[i] = std::min(steps[i], random.below(100));
    }
    expect_same_skip(detail::PathState<double>{start, line, steps}, 6 + 3 * random.below(3));
  }
}

TEST(CubeSkip, EndsWhereSingleStepsEndBetweenVoxelCentres) {
  Random random(8);
  for (int round = 0; round < 20'000; ++round) {
    const VoxelKey from = random.key_in(kAllVoxels);
    VoxelKey to = random.key_in(kAllVoxels);
    if (random.one_in(3))
      to = {static_cast<std::uint16_t>(from.x ^ 192), from.y, static_cast<std::uint16_t>(from.z ^ 192)};
    if (random.one_in(5)) to.x = from.x;
    const int log2_edge = 6 + 3 * random.below(3);
    const Block home{make_key(from.x >> log2_edge << log2_edge, from.y >> log2_edge << log2_edge,
                              from.z >> log2_edge << log2_edge),
                     log2_edge};
    if (cube(home.corner, 1 << log2_edge).contains(to)) continue;
    const auto line = detail::crossings_of(from, to);
    expect_same_skip(
        detail::PathState<std::int64_t>{
            from, line, {std::abs(from.x - to.x), std::abs(from.y - to.y), std::abs(from.z - to.z)}},
        log2_edge);
  }
}

}  // namespace
}  // namespace frontlux::test
