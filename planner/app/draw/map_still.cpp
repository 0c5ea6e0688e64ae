#include "draw/map_still.hpp"

#include "draw/robot_color.hpp"
#include "share_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <numbers>
#include <vector>

namespace frontlux::app {
namespace {

constexpr Color kPaper{255, 255, 255}, kInk{20, 20, 24}, kLow{86, 106, 140}, kMiddle{172, 178, 176},
    kHigh{233, 220, 180};
constexpr int kMargin = 24, kLine = 24, kLetters = 2, kMaxWidth = 1800, kMaxHeight = 1400;

// Seen from 18 degrees aside and 48 degrees above the ground; y and x point away from the viewer.
struct Projection {
  double sin_turn = std::sin(18.0 * std::numbers::pi / 180.0),
         cos_turn = std::cos(18.0 * std::numbers::pi / 180.0);
  double sin_rise = std::sin(48.0 * std::numbers::pi / 180.0),
         cos_rise = std::cos(48.0 * std::numbers::pi / 180.0);
  double scale = 1.0, left = 0.0, top = 0.0;  // [px] of a voxel; of the origin

  struct Spot {
    double x, y;  // [px]
  };
  // A point in voxels.
  [[nodiscard]] Spot spot(const Eigen::Vector3d& p) const {
    const double away = p.x() * sin_turn + p.y() * cos_turn;
    return {left + scale * (p.x() * cos_turn - p.y() * sin_turn),
            top - scale * (p.z() * cos_rise + away * sin_rise)};
  }
  // Of what covers each other, the nearer has the greater one.
  [[nodiscard]] double nearness(const Eigen::Vector3d& p) const {
    return p.z() * sin_rise - (p.x() * sin_turn + p.y() * cos_turn) * cos_rise;
  }
};

struct Face {
  Eigen::Vector3d middle;  // in voxels
  std::size_t axis;        // of its normal
};

Eigen::Vector3d in_voxels(const VoxelKey& key) {
  return {key.x - double{Lattice::kOrigin}, key.y - double{Lattice::kOrigin},
          key.z - double{Lattice::kOrigin}};
}

std::vector<Face> visible_faces(const VoxelGrid& grid) {
  std::vector<Face> faces;
  const auto look = [&](const VoxelKey& key) {
    const Eigen::Vector3d middle = in_voxels(key) + Eigen::Vector3d::Constant(0.5);
    const auto free = [&](int x, int y, int z) {
      if (x < 0 || y < 0 || z > 0xFFFF) return false;
      return grid.at({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                      static_cast<std::uint16_t>(z)}) == Occupancy::kFree;
    };
    if (free(key.x - 1, key.y, key.z)) faces.push_back({middle - 0.5 * Eigen::Vector3d::UnitX(), 0});
    if (free(key.x, key.y - 1, key.z)) faces.push_back({middle - 0.5 * Eigen::Vector3d::UnitY(), 1});
    if (free(key.x, key.y, key.z + 1)) faces.push_back({middle + 0.5 * Eigen::Vector3d::UnitZ(), 2});
  };
  grid.for_each_block([&](const Block& block, const Brick* brick, Occupancy state) {
    if (brick == nullptr && state != Occupancy::kOccupied) return;
    const int edge = 1 << block.log2_edge;
    for (int x = 0; x < edge; ++x)
      for (int y = 0; y < edge; ++y)
        for (int z = 0; z < edge; ++z) {
          const VoxelKey key{static_cast<std::uint16_t>(block.corner.x + x),
                             static_cast<std::uint16_t>(block.corner.y + y),
                             static_cast<std::uint16_t>(block.corner.z + z)};
          if (grid.at(key) == Occupancy::kOccupied) look(key);
        }
  });
  return faces;
}

Color mixed(Color a, Color b, double share) {
  const auto channel = [&](std::uint8_t from, std::uint8_t to) {
    return static_cast<std::uint8_t>(std::lround(from + share * (to - from)));
  };
  return {channel(a.red, b.red), channel(a.green, b.green), channel(a.blue, b.blue)};
}

Color face_color(const Face& face, double low, double high) {
  constexpr std::array<double, 3> kShadow = {0.3, 0.18, 0.0};
  const double share = high > low ? std::clamp((face.middle.z() - low) / (high - low), 0.0, 1.0) : 0.0;
  const Color lit = share < 0.5 ? mixed(kLow, kMiddle, 2 * share) : mixed(kMiddle, kHigh, 2 * share - 1);
  return mixed(lit, {0, 0, 0}, kShadow.at(face.axis));
}

// Pixels whose middle lies in the parallelogram of the face.
void fill_face(Canvas& canvas, const Projection& projection, const Face& face, Color color) {
  const auto unit = [](std::size_t axis) {
    return Eigen::Vector3d(Eigen::Vector3d::Unit(static_cast<Eigen::Index>(axis)));
  };
  const Eigen::Vector3d u = 0.5 * unit((face.axis + 1) % 3), v = 0.5 * unit((face.axis + 2) % 3);
  const auto middle = projection.spot(face.middle), to_u = projection.spot(face.middle + u),
             to_v = projection.spot(face.middle + v);
  const double ux = to_u.x - middle.x, uy = to_u.y - middle.y, vx = to_v.x - middle.x, vy = to_v.y - middle.y;
  const double area = ux * vy - uy * vx, reach_x = std::fabs(ux) + std::fabs(vx),
               reach_y = std::fabs(uy) + std::fabs(vy);
  if (area == 0.0) return;
  constexpr double kInside = 1.0 + 1e-9;
  for (int y = static_cast<int>(std::floor(middle.y - reach_y)); y <= middle.y + reach_y; ++y)
    for (int x = static_cast<int>(std::floor(middle.x - reach_x)); x <= middle.x + reach_x; ++x) {
      const double dx = x + 0.5 - middle.x, dy = y + 0.5 - middle.y;
      if (std::fabs(dx * vy - dy * vx) <= kInside * std::fabs(area) &&
          std::fabs(ux * dy - uy * dx) <= kInside * std::fabs(area))
        canvas.set(x, y, color);
    }
}

// Fits all faces and ways between the margins.
Projection fit(const std::vector<Eigen::Vector3d>& points, int header, int& width, int& height) {
  Projection projection;
  double min_x = 0, max_x = 1, min_y = 0, max_y = 1;
  bool first = true;
  for (const Eigen::Vector3d& point : points) {
    const auto [x, y] = projection.spot(point);
    min_x = first ? x - 1 : std::min(min_x, x - 1);
    max_x = first ? x + 1 : std::max(max_x, x + 1);
    min_y = first ? y - 1 : std::min(min_y, y - 1);
    max_y = first ? y + 1 : std::max(max_y, y + 1);
    first = false;
  }
  projection.scale = std::clamp(std::min((kMaxWidth - 2 * kMargin) / (max_x - min_x),
                                         (kMaxHeight - 2 * kMargin - header) / (max_y - min_y)),
                                1.0, 24.0);
  width = std::max(760, static_cast<int>(std::ceil(projection.scale * (max_x - min_x))) + 2 * kMargin);
  height = static_cast<int>(std::ceil(projection.scale * (max_y - min_y))) + 2 * kMargin + header;
  projection.left = (width - projection.scale * (max_x + min_x)) / 2;
  projection.top = kMargin + header - projection.scale * min_y;
  return projection;
}

std::vector<Eigen::Vector3d> way_of(const planner::Recording& recording, std::size_t robot) {
  std::vector<Eigen::Vector3d> way;
  const double resolution = recording.head.resolution;
  for (const planner::RecordedStep& step : recording.steps) {
    const planner::RobotStep& moved = step.step.robots[robot];
    for (std::size_t i = 0; i < std::min(moved.travelled, moved.planned.size()); ++i)
      way.push_back(moved.planned[i].position / resolution);
  }
  return way;
}

void draw_way(Canvas& canvas, const Projection& projection, const std::vector<Eigen::Vector3d>& way,
              Color color) {
  const auto pass = [&](double thickness, Color with) {
    for (std::size_t i = 1; i < way.size(); ++i) {
      const auto a = projection.spot(way[i - 1]), b = projection.spot(way[i]);
      canvas.line(a.x, a.y, b.x, b.y, thickness, with);
    }
  };
  pass(5.0, kPaper);
  pass(2.6, color);
  if (way.empty()) return;
  const auto begin = projection.spot(way.front()), end = projection.spot(way.back());
  canvas.disc(begin.x, begin.y, 8, kPaper);
  canvas.ring(begin.x, begin.y, 5, 3, color);
  canvas.disc(end.x, end.y, 9, kPaper);
  canvas.disc(end.x, end.y, 6.5, color);
}

std::string summary_of(const planner::Recording& recording) {
  std::uint64_t known = 0;
  for (const planner::KnownVoxels& part : recording.steps.back().known) known += part.observable;
  const double total = static_cast<double>(recording.head.observable);
  const std::string step = "step " + std::to_string(recording.steps.back().step.number);
  if (total == 0.0) return "after " + step;
  return share_text(static_cast<double>(known) / total, 1) + " known after " + step;
}

// What a run is called, and where it was, if the name does not say so.
std::string title_of(const std::string& name, const planner::Recording& recording) {
  const std::string& world = recording.head.world;
  return name == world ? name + ": " : name + ": " + world + ", ";
}

}  // namespace

Canvas draw_final_map(const planner::Recording& recording, const std::string& name) {
  VoxelGrid grid(recording.head.resolution);
  for (const planner::RecordedStep& step : recording.steps)
    for (const planner::RobotStep& robot : step.step.robots)
      for (const planner::VoxelChange& change : robot.changed) grid.set(change.key, change.after);
  std::vector<Face> faces = visible_faces(grid);
  std::vector<std::vector<Eigen::Vector3d>> ways;
  for (std::size_t r = 0; r < recording.head.robots.size(); ++r) ways.push_back(way_of(recording, r));

  std::vector<Eigen::Vector3d> points;
  double low = 0.0, high = 0.0;
  for (const Face& face : faces) {
    low = points.empty() ? face.middle.z() : std::min(low, face.middle.z());
    high = points.empty() ? face.middle.z() : std::max(high, face.middle.z());
    points.push_back(face.middle);
  }
  for (const auto& way : ways) points.insert(points.end(), way.begin(), way.end());
  const int header = kLine * (1 + static_cast<int>(ways.size()));
  int width = 0, height = 0;
  const Projection projection = fit(points, header, width, height);
  Canvas canvas(width, height, kPaper);

  std::sort(faces.begin(), faces.end(), [&](const Face& a, const Face& b) {
    return projection.nearness(a.middle) < projection.nearness(b.middle);
  });
  for (const Face& face : faces) fill_face(canvas, projection, face, face_color(face, low, high));
  for (std::size_t r = 0; r < ways.size(); ++r) draw_way(canvas, projection, ways[r], robot_color(r));

  canvas.text(kMargin, kMargin, title_of(name, recording) + summary_of(recording), kLetters, kInk);
  for (std::size_t r = 0; r < ways.size(); ++r) {
    const int y = kMargin + kLine * (1 + static_cast<int>(r));
    canvas.fill(kMargin, y + 4, 26, 6, robot_color(r));
    double length = 0.0;
    for (const planner::RecordedStep& step : recording.steps) length += step.step.robots[r].length;
    std::array<char, 64> metres{};
    std::snprintf(metres.data(), metres.size(), "  %.0f m", length);
    canvas.text(kMargin + 36, y, recording.head.robots[r].robot.name + metres.data(), kLetters, kInk);
  }
  return canvas;
}

}  // namespace frontlux::app
