#include "draw/colors.hpp"
#include "draw/counts_seconds.hpp"
#include "draw/stills.hpp"
#include "text.hpp"

#include <frontlux/key_box.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace frontlux::app {
namespace {

constexpr Color kPaper{255, 255, 255}, kInk{20, 20, 24}, kLow{86, 106, 140}, kMiddle{172, 178, 176},
    kHigh{233, 220, 180};
constexpr int kMargin = 24, kLine = 24, kMaxWidth = 1800, kMaxHeight = 1400;

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

std::vector<Face> visible_faces(const VoxelGrid& grid) {
  std::vector<Face> faces;
  const auto add_faces = [&](const VoxelKey& key) {
    const Eigen::Vector3d middle = Lattice(1.0).exact_center(key);
    const auto add = [&](std::size_t axis, int side) {
      const Eigen::Vector3i step = side * Eigen::Vector3i::Unit(static_cast<Eigen::Index>(axis));
      const auto next = offset_key(key, step.x(), step.y(), step.z());
      if (next && grid.at(*next) == Occupancy::kFree)
        faces.push_back({middle + 0.5 * step.cast<double>(), axis});
    };
    add(0, -1);
    add(1, -1);
    add(2, 1);
  };
  grid.for_each_block([&](const Block& block, const Brick* brick, Occupancy state) {
    if (brick == nullptr && state != Occupancy::kOccupied) return;
    for_each_key(cube(block.corner, 1 << block.log2_edge), [&](const VoxelKey& key) {
      if (grid.at(key) == Occupancy::kOccupied) add_faces(key);
    });
  });
  return faces;
}

Color mixed(Color a, Color b, double fraction) {
  const auto channel = [&](std::uint8_t from, std::uint8_t to) {
    return static_cast<std::uint8_t>(std::lround(from + fraction * (to - from)));
  };
  return {channel(a.red, b.red), channel(a.green, b.green), channel(a.blue, b.blue)};
}

Color face_color(const Face& face, double low, double high) {
  constexpr std::array<double, 3> kShade = {0.3, 0.18, 0.0};
  const double fraction = high > low ? std::clamp((face.middle.z() - low) / (high - low), 0.0, 1.0) : 0.0;
  const Color lit =
      fraction < 0.5 ? mixed(kLow, kMiddle, 2 * fraction) : mixed(kMiddle, kHigh, 2 * fraction - 1);
  return mixed(lit, {0, 0, 0}, kShade.at(face.axis));
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

// Fits all faces and paths between the margins.
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

std::vector<Eigen::Vector3d> path_of(const planner::Recording& recording, std::size_t robot) {
  std::vector<Eigen::Vector3d> path;
  const double resolution = recording.head.resolution;
  for (const planner::RecordedStep& step : recording.steps) {
    const planner::RobotStep& moved = step.step.robots[robot];
    for (std::size_t i = 0; i < std::min(moved.travelled, moved.planned.size()); ++i)
      path.push_back(moved.planned[i].position / resolution);
  }
  return path;
}

void draw_path(Canvas& canvas, const Projection& projection, const std::vector<Eigen::Vector3d>& path,
               Color color) {
  const auto pass = [&](double thickness, Color with) {
    for (std::size_t i = 1; i < path.size(); ++i) {
      const auto a = projection.spot(path[i - 1]), b = projection.spot(path[i]);
      canvas.line(a.x, a.y, b.x, b.y, thickness, with);
    }
  };
  pass(5.0, kPaper);
  pass(2.6, color);
  if (path.empty()) return;
  const auto begin = projection.spot(path.front()), end = projection.spot(path.back());
  canvas.disc(begin.x, begin.y, 8, kPaper);
  canvas.ring(begin.x, begin.y, 5, 3, color);
  canvas.disc(end.x, end.y, 9, kPaper);
  canvas.disc(end.x, end.y, 6.5, color);
}

std::string summary_of(const planner::Recording& recording) {
  std::uint64_t known = 0;
  for (const planner::KnownVoxels& part : recording.steps.back().known) known += part.observable;
  const double total = static_cast<double>(recording.head.observable);
  const planner::ExplorationStep& last = recording.steps.back().step;
  const std::string when =
      counts_seconds(recording) ? fixed(last.time, 1) + " s" : "step " + std::to_string(last.number);
  if (total == 0.0) return "after " + when;
  return percent(static_cast<double>(known) / total, 1) + " mapped after " + when;
}

// The name of a run, and its world if the name does not say it.
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
  std::vector<std::vector<Eigen::Vector3d>> paths;
  for (std::size_t r = 0; r < recording.head.robots.size(); ++r) paths.push_back(path_of(recording, r));

  std::vector<Eigen::Vector3d> points;
  double low = 0.0, high = 0.0;
  for (const Face& face : faces) {
    low = points.empty() ? face.middle.z() : std::min(low, face.middle.z());
    high = points.empty() ? face.middle.z() : std::max(high, face.middle.z());
    points.push_back(face.middle);
  }
  for (const auto& path : paths) points.insert(points.end(), path.begin(), path.end());
  const int header = kLine * (1 + static_cast<int>(paths.size()));
  int width = 0, height = 0;
  const Projection projection = fit(points, header, width, height);
  Canvas canvas(width, height, kPaper);

  std::sort(faces.begin(), faces.end(), [&](const Face& a, const Face& b) {
    return projection.nearness(a.middle) < projection.nearness(b.middle);
  });
  for (const Face& face : faces) fill_face(canvas, projection, face, face_color(face, low, high));
  const std::vector<Color> colors = robot_colors(recording.head.robots);
  for (std::size_t r = 0; r < paths.size(); ++r) draw_path(canvas, projection, paths[r], colors[r]);

  canvas.text(kMargin, kMargin, title_of(name, recording) + summary_of(recording), kInk);
  for (std::size_t r = 0; r < paths.size(); ++r) {
    const int y = kMargin + kLine * (1 + static_cast<int>(r));
    canvas.fill(kMargin, y + 4, 26, 6, colors[r]);
    double length = 0.0;
    for (const planner::RecordedStep& step : recording.steps) length += step.step.robots[r].length;
    canvas.text(kMargin + 36, y, recording.head.robots[r].robot.name + "  " + fixed(length, 0) + " m", kInk);
  }
  return canvas;
}

}  // namespace frontlux::app
