#include "report/report_folder.hpp"

#include <frontlux/planner/recorded_map.hpp>

namespace frontlux::report {
namespace {

using planner::Recording;
using test::decode;
using test::Decoded;
using test::packed_runs;
using test::Reader;
using ReportDataTest = test::ReportFolder;

using Cells = std::vector<planner::RenderedCell>;
using Changes = std::map<VoxelKey, Occupancy>;

Changes read_changes(Reader& data) {
  Changes changes;
  for (std::uint64_t chunks = data.count(); chunks > 0; --chunks) {
    const std::uint64_t x = data.count(), y = data.count(), z = data.count();
    std::uint64_t local = 0;
    for (std::uint64_t voxels = data.count(); voxels > 0; --voxels) {
      const std::uint64_t change = data.count();
      local += change / 4;
      EXPECT_LT(local, 32U * 32U * 32U);
      const VoxelKey key{static_cast<std::uint16_t>(32 * x + local % 32),
                         static_cast<std::uint16_t>(32 * y + local / 32 % 32),
                         static_cast<std::uint16_t>(32 * z + local / 1024)};
      EXPECT_TRUE(changes.emplace(key, static_cast<Occupancy>(change % 4)).second);
    }
  }
  return changes;
}

void expect_image(Reader& data, std::vector<planner::RenderedCell> cells) {
  ASSERT_EQ(data.count(), cells.size());
  if (cells.empty()) return;
  std::stable_sort(cells.begin(), cells.end(), [](const auto& a, const auto& b) {
    return std::tie(a.cell.z, a.cell.y, a.cell.x) < std::tie(b.cell.z, b.cell.y, b.cell.x);
  });
  const double gain = data.f32(), quality = data.f32();
  const auto by = [](auto member) {
    return [member](const auto& a, const auto& b) { return a.*member < b.*member; };
  };
  using Cell = planner::RenderedCell;
  EXPECT_EQ(gain, static_cast<float>(std::max_element(cells.begin(), cells.end(), by(&Cell::gain))->gain));
  EXPECT_EQ(quality,
            static_cast<float>(std::max_element(cells.begin(), cells.end(), by(&Cell::quality))->quality));
  for (const auto axis : {&VoxelKey::x, &VoxelKey::y, &VoxelKey::z}) {
    std::int64_t key = 0;
    for (const Cell& cell : cells) {
      key += data.difference();
      ASSERT_EQ(key, cell.cell.*axis);
    }
  }
  // A byte's step, and half of it for rounding; the quality's is on a scale of square roots.
  for (const Cell& cell : cells) EXPECT_NEAR(data.u8() / 255.0 * gain, cell.gain, 0.51 / 255.0 * gain);
  for (const Cell& cell : cells)
    EXPECT_NEAR(data.u8() / 255.0, quality > 0 ? std::sqrt(cell.quality / quality) : 0.0, 0.51 / 255.0);
}

TEST_F(ReportDataTest, VoxelsImagesAndPathsAreThoseOfTheRecording) {
  Decoded run = decode(packed_runs(page_of({{"room", &room()}})).at(0));
  planner::RecordedMap map(room().head.resolution);
  Changes shown;
  std::size_t images = 0, reassigned = 0;
  for (const planner::RecordedStep& recorded : room().steps) {
    map.apply(recorded);
    for (const planner::RobotStep& robot : recorded.step.robots) {
      for (const auto& [key, state] : read_changes(run.data)) shown[key] = state;
      expect_image(run.data, robot.image);
      images += robot.image.empty() ? 0 : 1;
      ASSERT_EQ(run.data.count(), robot.planned.size());
      ASSERT_EQ(run.data.count(), robot.travelled);
      for (const planner::Pose& pose : robot.planned) {
        for (const double coordinate : pose.position)
          EXPECT_EQ(run.data.f32(), static_cast<float>(coordinate));
        EXPECT_EQ(run.data.f32(), static_cast<float>(pose.yaw));
      }
      EXPECT_EQ(run.data.count(), 0U) << "in lock-step there are no tours";
      EXPECT_EQ(run.data.count(), 0U) << "and no trajectories";
      ASSERT_EQ(run.data.count(), robot.reassigned.size());
      EXPECT_EQ(run.data.keys(robot.reassigned.size()), robot.reassigned);
      reassigned += robot.reassigned.size();
    }
    std::array<std::uint64_t, 3> counted{};
    for (const auto& [key, state] : shown) {
      ASSERT_EQ(map.grid().at(key), state);
      ++counted.at(static_cast<std::size_t>(state));
    }
    EXPECT_EQ(counted[1], map.grid().count()[1]);
    EXPECT_EQ(counted[2], map.grid().count()[2]);
  }
  EXPECT_EQ(run.data.at, run.data.bytes.size());
  EXPECT_GT(images, 2U);
  EXPECT_GT(reassigned, 100U);
  EXPECT_GT(shown.size(), 10'000U);
}

TEST_F(ReportDataTest, ToursAreThoseOfTheRecording) {
  Recording recording = room();
  recording.steps.resize(1);
  for (planner::RobotStep& robot : recording.steps[0].step.robots) {
    robot.changed.clear();
    robot.image.clear();
    robot.planned.clear();
    robot.travelled = 0;
    robot.reassigned = {{5, 6, 7}, {5, 65535, 0}, {6, 1, 2}};
  }
  recording.steps[0].step.robots[0].trajectory = {{{1.0, 2.0, 0.5}, 0.1}, {{-3.0, 2.5, 0.5}, 0.2}};
  recording.steps[0].step.robots[1].tour = {{{{1.5, -2.0, 3.25}, 0.5}, 3, 400},
                                            {{{0.1, 0.2, 0.3}, -4.0}, 1, 10}};
  Reader data = decode(packed_runs(page_of({{"room", &recording}})).at(0)).data;
  for (const planner::RobotStep& robot : recording.steps[0].step.robots) {
    for (int nothing = 0; nothing < 4; ++nothing) ASSERT_EQ(data.count(), 0U);
    ASSERT_EQ(data.count(), robot.tour.size());
    for (const planner::PlannedStop& stop : robot.tour) {
      for (const double coordinate : stop.pose.position)
        EXPECT_EQ(data.f32(), static_cast<float>(coordinate));
      EXPECT_EQ(data.f32(), static_cast<float>(stop.pose.yaw));
      EXPECT_EQ(data.count(), stop.clusters);
      EXPECT_EQ(data.count(), stop.frontiers);
    }
    ASSERT_EQ(data.count(), robot.trajectory.size());
    for (const planner::Pose& pose : robot.trajectory)
      for (const double coordinate : pose.position) EXPECT_EQ(data.f32(), static_cast<float>(coordinate));
    ASSERT_EQ(data.count(), robot.reassigned.size());
    EXPECT_EQ(data.keys(robot.reassigned.size()), robot.reassigned);
  }
  EXPECT_EQ(data.at, data.bytes.size());
}

TEST_F(ReportDataTest, OfManyImagesSomeAreShown) {
  Recording recording = room();
  const auto with_image =
      std::find_if(room().steps.begin(), room().steps.end(),
                   [](const planner::RecordedStep& step) { return !step.step.robots[0].image.empty(); });
  ASSERT_NE(with_image, room().steps.end());
  recording.steps.assign(1001, *with_image);
  for (planner::RecordedStep& step : recording.steps) step.step.robots[1].image.clear();
  recording.steps[0].step.robots[0].image.clear();
  recording.steps[7].step.robots[1].image = with_image->step.robots[0].image;
  Decoded run = decode(packed_runs(page_of({{"room", &recording}})).at(0));
  std::array<std::vector<std::size_t>, 2> shown;
  for (std::size_t s = 0; s < recording.steps.size(); ++s)
    for (std::size_t r = 0; r < 2; ++r) {
      read_changes(run.data);
      const bool here = run.data.bytes.at(run.data.at) != 0;
      if (here) shown.at(r).push_back(s);
      expect_image(run.data, here ? recording.steps[s].step.robots[r].image : Cells{});
      const std::uint64_t poses = run.data.count();
      run.data.count();  // of them, those that it reached
      run.data.at += 16 * poses;
      EXPECT_EQ(run.data.count(), 0U);  // no tour
      EXPECT_EQ(run.data.count(), 0U);  // no trajectory
      run.data.keys(run.data.count());
    }
  EXPECT_EQ(run.data.at, run.data.bytes.size());
  // Of a thousand, every third one.
  ASSERT_EQ(shown[0].size(), 334U);
  for (std::size_t i = 0; i < shown[0].size(); ++i) EXPECT_EQ(shown[0][i], 1 + 3 * i);
  EXPECT_EQ(shown[1], std::vector<std::size_t>{7});
}

}  // namespace
}  // namespace frontlux::report
