#include "octomap/quiet_octomap.hpp"
#include "support/random.hpp"

#include <frontlux/lattice.hpp>

namespace frontlux::test {
namespace {

TEST(Lattice, KeysAndCentresAreOctomapsOwn) {
  Random random(1);
  for (const double resolution : {0.05, 0.1, 0.3, 0.37, 1.0, 2.5}) {
    const octomap::OcTree tree(resolution);
    const Lattice lattice(resolution);
    for (int i = 0; i < 20'000; ++i) {
      const double reach = 33'000 * resolution;
      double coordinate = random.uniform(-reach, reach);
      if (i % 3 == 0) coordinate = (random.below(66'000) - 33'000) * resolution;  // faces
      if (i % 3 == 1)
        coordinate = static_cast<float>((random.below(66'000) - 33'000) * resolution);  // as a float
      octomap::key_type expected = 0;
      const bool inside = tree.coordToKeyChecked(coordinate, expected);
      const auto key = lattice.key(coordinate);
      ASSERT_EQ(key.has_value(), inside) << coordinate;
      if (inside) {
        ASSERT_EQ(*key, expected) << coordinate;
        ASSERT_EQ(lattice.center(*key), tree.keyToCoord(expected));
      }
    }
  }
}

TEST(Lattice, NoKeyOutsideTheKeyRangeOrForWhatIsNoNumber) {
  const Lattice lattice(0.5);
  EXPECT_EQ(lattice.key(-16384.0), std::uint16_t{0});
  EXPECT_EQ(lattice.key(16383.99), std::uint16_t{65535});
  EXPECT_FALSE(lattice.key(16384.0));
  EXPECT_FALSE(lattice.key(-16384.01));
  EXPECT_FALSE(lattice.key(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_FALSE(lattice.key(std::numeric_limits<double>::infinity()));
  EXPECT_FALSE(lattice.key(-1e300));
  EXPECT_FALSE(lattice.key(Eigen::Vector3f(0.0F, 0.0F, 1e30F)));
}

TEST(Lattice, RejectsResolutionsThatAreNoLength) {
  for (const double bad :
       {0.0, -0.1, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
        std::numeric_limits<double>::denorm_min()})
    EXPECT_THROW(Lattice{bad}, std::invalid_argument) << bad;
}

}  // namespace
}  // namespace frontlux::test
