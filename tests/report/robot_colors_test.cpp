#include "support/test.hpp"

#include <frontlux/report/robot_colors.hpp>

namespace frontlux::report {
namespace {

// A robot has one colour, alone and in any team, and no two of a team have the same as long as there are
// enough.
TEST(RobotColors, GoByIdentity) {
  const auto named = [](planner::RobotDescription description, const std::string& name) {
    description.robot.name = name;
    return description;
  };
  const planner::RobotDescription ground = planner::ugv_description(), air = planner::uav_description();
  const auto colors_of = [](const std::vector<planner::RobotDescription>& team) {
    std::vector<std::string> colors;
    for (const ColorPair& color : robot_colors(team)) {
      EXPECT_NE(color.light, color.dark);
      colors.emplace_back(color.light);
    }
    return colors;
  };
  const std::string uav = colors_of({air})[0], ugv = colors_of({ground})[0];
  EXPECT_NE(uav, ugv);
  EXPECT_EQ(colors_of({ground, air}), (std::vector{ugv, uav}));
  const auto three = colors_of({named(air, "uav1"), ground, named(air, "uav2")});
  EXPECT_EQ(three[0], uav);
  EXPECT_EQ(three[1], ugv);
  EXPECT_EQ(colors_of({named(air, "uav2")})[0], three[2]);
  EXPECT_EQ(colors_of({named(air, "uav2"), named(air, "uav1")}), (std::vector{three[2], uav}));
  const auto named_alike = colors_of({named(air, "heron"), named(air, "kite"), named(air, "uav2")});
  EXPECT_EQ(std::set(named_alike.begin(), named_alike.end()).size(), 3U);
  EXPECT_EQ(named_alike[0], uav);
  EXPECT_EQ(colors_of(std::vector(40, air)).size(), 40U);
  EXPECT_EQ(colors_of({named(air, "uav99999999999999999999"), named(air, ""), named(air, "0")}).size(), 3U);
}

}  // namespace
}  // namespace frontlux::report
