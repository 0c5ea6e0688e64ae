#include "parts.hpp"

#include <frontlux/file.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <tuple>
#include <vector>

namespace frontlux::report::detail {
namespace {

constexpr unsigned kChunkBits = 5;
constexpr unsigned kInChunk = (1U << kChunkBits) - 1;
constexpr std::size_t kMostImages = 400;  // of a robot: those of long runs would be most of the file

// Numbers as bytes, in the order in which the page reads them (web/src/byte_reader.js).
class ByteWriter {
 public:
  void u8(std::uint8_t number) { bytes_ += static_cast<char>(number); }

  void count(std::uint64_t number) {
    for (; number >= 0x80; number >>= 7U) u8(static_cast<std::uint8_t>((number & 0x7FU) | 0x80U));
    u8(static_cast<std::uint8_t>(number));
  }

  // Small numbers of either sign take few bytes.
  void difference(std::int64_t number) {
    count((static_cast<std::uint64_t>(number) << 1U) ^ static_cast<std::uint64_t>(number >> 63));
  }

  void f32(double number) { append_number(bytes_, std::bit_cast<std::uint32_t>(static_cast<float>(number))); }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

// A changed voxel by where the page keeps it.
struct Placed {
  std::uint64_t chunk;  // x, y, z of 16 bits each
  std::uint32_t local;
  Occupancy state;
};

void write_changes(ByteWriter& out, std::span<const planner::VoxelChange> changes) {
  std::vector<Placed> placed;
  placed.reserve(changes.size());
  for (const auto& [key, before, after] : changes) {
    const std::uint64_t chunk = std::uint64_t{key.x} >> kChunkBits << 32U |
                                std::uint64_t{key.y} >> kChunkBits << 16U |
                                std::uint64_t{key.z} >> kChunkBits;
    const std::uint32_t local =
        (key.x & kInChunk) | (key.y & kInChunk) << kChunkBits | (key.z & kInChunk) << 2 * kChunkBits;
    placed.push_back({chunk, local, after});
  }
  std::sort(placed.begin(), placed.end(), [](const Placed& a, const Placed& b) {
    return std::tie(a.chunk, a.local) < std::tie(b.chunk, b.local);
  });
  std::size_t chunks = 0;
  for (std::size_t i = 0; i < placed.size(); ++i)
    if (i == 0 || placed[i].chunk != placed[i - 1].chunk) ++chunks;
  out.count(chunks);
  for (std::size_t begin = 0, end = 0; begin < placed.size(); begin = end) {
    const std::uint64_t chunk = placed[begin].chunk;
    while (end < placed.size() && placed[end].chunk == chunk) ++end;
    out.count(chunk >> 32U);
    out.count(chunk >> 16U & 0xFFFFU);
    out.count(chunk & 0xFFFFU);
    out.count(end - begin);
    std::uint32_t last = 0;
    for (std::size_t i = begin; i < end; ++i) {
      out.count(std::uint64_t{placed[i].local - last} << 2U | static_cast<unsigned>(placed[i].state));
      last = placed[i].local;
    }
  }
}

std::uint8_t byte_of(double fraction) {
  return static_cast<std::uint8_t>(fraction > 0.0 ? std::lround(255.0 * std::min(fraction, 1.0)) : 0);
}

// x of all, as differences from the one before; then y, then z.
template <class Element, class Key = std::identity>
void write_keys(ByteWriter& out, const std::vector<Element>& list, const Key& key = {}) {
  for (const auto axis : {&VoxelKey::x, &VoxelKey::y, &VoxelKey::z}) {
    int last = 0;
    for (const Element& element : list) {
      out.difference(std::invoke(key, element).*axis - last);
      last = std::invoke(key, element).*axis;
    }
  }
}

void write_image(ByteWriter& out, std::vector<planner::RenderedCell> cells) {
  out.count(cells.size());
  if (cells.empty()) return;
  std::stable_sort(cells.begin(), cells.end(), [](const auto& a, const auto& b) {
    return std::tie(a.cell.z, a.cell.y, a.cell.x) < std::tie(b.cell.z, b.cell.y, b.cell.x);
  });
  double gain = 0.0, quality = 0.0;
  for (const planner::RenderedCell& cell : cells) {
    gain = std::max(gain, cell.gain);
    quality = std::max(quality, cell.quality);
  }
  out.f32(gain);
  out.f32(quality);
  write_keys(out, cells, &planner::RenderedCell::cell);
  for (const planner::RenderedCell& cell : cells) out.u8(byte_of(gain > 0.0 ? cell.gain / gain : 0.0));
  for (const planner::RenderedCell& cell : cells)
    out.u8(byte_of(quality > 0.0 ? std::sqrt(cell.quality / quality) : 0.0));
}

void write_path(ByteWriter& out, const planner::RobotStep& robot) {
  out.count(robot.planned.size());
  out.count(std::min(robot.travelled, robot.planned.size()));
  for (const planner::Pose& pose : robot.planned) {
    for (const double coordinate : pose.position) out.f32(coordinate);
    out.f32(pose.yaw);
  }
}

void write_tour(ByteWriter& out, std::span<const planner::PlannedStop> tour) {
  out.count(tour.size());
  for (const planner::PlannedStop& stop : tour) {
    for (const double coordinate : stop.pose.position) out.f32(coordinate);
    out.f32(stop.pose.yaw);
    out.count(stop.clusters);
    out.count(stop.frontiers);
  }
}

void write_plan(ByteWriter& out, const planner::RobotStep& robot) {
  out.count(robot.trajectory.size());
  for (const planner::Pose& pose : robot.trajectory)
    for (const double coordinate : pose.position) out.f32(coordinate);
  out.count(robot.reassigned.size());
  write_keys(out, robot.reassigned);
}

// Of each robot, every how many-th image goes into the report.
std::vector<std::size_t> image_strides(const planner::Recording& recording) {
  std::vector<std::size_t> strides(recording.head.robots.size());
  for (const planner::RecordedStep& step : recording.steps)
    for (std::size_t r = 0; r < strides.size(); ++r) strides[r] += step.step.robots[r].image.empty() ? 0 : 1;
  for (std::size_t& stride : strides)
    stride = std::max<std::size_t>(1, (stride + kMostImages - 1) / kMostImages);
  return strides;
}

}  // namespace

std::string run_data(const planner::Recording& recording) {
  ByteWriter out;
  const std::vector<std::size_t> strides = image_strides(recording);
  std::vector<std::size_t> images(strides.size());
  for (const planner::RecordedStep& step : recording.steps)
    for (std::size_t r = 0; r < strides.size(); ++r) {
      const planner::RobotStep& robot = step.step.robots[r];
      const bool shown = !robot.image.empty() && images[r]++ % strides[r] == 0;
      write_changes(out, robot.changed);
      write_image(out, shown ? robot.image : std::vector<planner::RenderedCell>());
      write_path(out, robot);
      write_tour(out, robot.tour);
      write_plan(out, robot);
    }
  return out.bytes();
}

}  // namespace frontlux::report::detail
