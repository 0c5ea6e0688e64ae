#include "support/complaint.hpp"

#include <frontlux/sim/scan_messages.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace frontlux::sim {
namespace {

MovingRobots::Sensed scan_at(double time, std::size_t robot) { return {time, robot, {}, {}}; }

TEST(ScanMessages, ArriveAtOnceByDefault) {
  ScanMessages messages({}, 1);
  messages.send(scan_at(0.5, 2));
  const auto scans = messages.arrived(0.5);
  ASSERT_EQ(scans.size(), 1U);
  EXPECT_EQ(scans[0].robot, 2U);
  EXPECT_TRUE(messages.arrived(10.0).empty()) << "once";
}

TEST(ScanMessages, ArriveInOrderAfterTheDelay) {
  ScanMessages messages({.delay = 1.0}, 1);
  for (std::size_t i = 0; i < 4; ++i) messages.send(scan_at(0.25 * static_cast<double>(i), i));
  EXPECT_TRUE(messages.arrived(0.99).empty());
  EXPECT_EQ(messages.next_arrival(), 1.0);
  EXPECT_EQ(messages.arrived(1.0).size(), 1U);
  const auto rest = messages.arrived(1.75);
  ASSERT_EQ(rest.size(), 3U);
  EXPECT_EQ(messages.next_arrival(), std::nullopt);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(rest[i].robot, i + 1);
}

TEST(ScanMessages, ArriveInTimeWhateverIsRounded) {
  for (const double rate : {10.0, 15.0, 30.0})
    for (int periods = 1; periods < 5; ++periods) {
      ScanMessages messages({.delay = periods / rate}, 1);
      for (int i = 0; i < 200; ++i) {
        messages.send(scan_at(i / rate, 0));
        EXPECT_EQ(messages.arrived(i / rate).size(), i < periods ? 0U : 1U) << i << " of " << rate << " Hz";
      }
    }
}

TEST(ScanMessages, LoseThePartThatIsAskedFor) {
  for (const double loss : {0.0, 0.2, 1.0}) {
    constexpr std::size_t kCount = 10000;
    ScanMessages messages({.loss = loss}, 7), again({.loss = loss}, 7), other({.loss = loss}, 8);
    std::vector<std::size_t> came[3];
    for (std::size_t i = 0; i < kCount; ++i)
      for (std::size_t m = 0; ScanMessages* const one : {&messages, &again, &other}) {
        one->send(scan_at(0.0, i));
        for (const auto& scan : one->arrived(0.0)) came[m].push_back(scan.robot);
        ++m;
      }
    const double lost = 1.0 - static_cast<double>(came[0].size()) / kCount;
    EXPECT_NEAR(lost, loss, 5 * std::sqrt(loss * (1 - loss) / kCount));
    EXPECT_EQ(came[0], came[1]);
    if (loss > 0.0 && loss < 1.0) {
      EXPECT_NE(came[0], came[2]);
    }
  }
}

TEST(ScanMessages, RefuseWhatIsNoDelayAndNoPart) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double delay : {-0.1, kInfinity, std::nan("")}) EXPECT_REFUSED(ScanMessages({delay, 0.0}, 1));
  for (const double loss : {-0.1, 1.1, std::nan("")}) EXPECT_REFUSED(ScanMessages({0.0, loss}, 1));
}

}  // namespace
}  // namespace frontlux::sim
