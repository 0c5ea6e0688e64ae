#include "draw/view_picture.hpp"

#include "draw/colors.hpp"
#include "draw/round_length.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

namespace frontlux::app {
namespace {

constexpr Color kUnknown{150, 150, 156}, kFree{226, 226, 230}, kOccupied{38, 38, 44};
constexpr int kMargin = 24, kPanel = 260, kLine = 28;
constexpr TextStyle kText{.size = 19.0, .color = kInk};
constexpr int kWidth = 900;                   // [px] of the longer edge of the map, about
constexpr int kMinScale = 3, kMaxScale = 24;  // [px] of a voxel
constexpr int kMaxPixels = 12000;             // of an edge
constexpr double kAround = 2.0;               // [m] shown around cells and frontiers

// The part of the map that is shown, in columns of voxels; y grows upwards in it.
struct Window {
  int min_x, max_x, min_y, max_y;
  int scale = 1;                // [px] of a voxel
  int left = kMargin, top = 0;  // of the map in the picture

  [[nodiscard]] int columns() const { return max_x - min_x + 1; }
  [[nodiscard]] int rows() const { return max_y - min_y + 1; }
  [[nodiscard]] std::size_t place(int x, int y) const {
    return static_cast<std::size_t>((y - min_y) * columns() + x - min_x);
  }
  // In the map.
  [[nodiscard]] int pixel_x(int key) const { return (key - min_x) * scale; }
  [[nodiscard]] int pixel_y(int key) const { return (max_y - key) * scale; }
};

Window choose_window(const ViewScene& scene) {
  const Lattice& lattice = scene.grid.lattice();
  const int x = lattice.key(scene.pose.position.x()).value(),
            y = lattice.key(scene.pose.position.y()).value();
  Window window{x, x, y, y};
  const auto include = [&](const VoxelKey& key) {
    window.min_x = std::min<int>(window.min_x, key.x);
    window.max_x = std::max<int>(window.max_x, key.x);
    window.min_y = std::min<int>(window.min_y, key.y);
    window.max_y = std::max<int>(window.max_y, key.y);
  };
  for (const auto& cell : scene.cells) include(cell.cell);
  for (const VoxelKey& key : scene.frontiers) include(key);
  const int around = static_cast<int>(std::ceil(kAround / lattice.resolution()));
  window.min_x = std::max(window.min_x - around, 0);
  window.min_y = std::max(window.min_y - around, 0);
  window.max_x = std::min(window.max_x + around, 0xFFFF);
  window.max_y = std::min(window.max_y + around, 0xFFFF);
  const int longer = std::max(window.columns(), window.rows());
  window.scale = std::clamp((kWidth + longer - 1) / longer, kMinScale, kMaxScale);
  while (window.scale > 1 && longer * window.scale > kMaxPixels) --window.scale;
  if (longer > kMaxPixels)
    throw std::invalid_argument("a picture of " + std::to_string(window.columns()) + " x " +
                                std::to_string(window.rows()) + " voxels is too large; write .csv or .ply");
  window.top = kMargin + kLine * static_cast<int>(scene.title.size()) + kMargin / 2;
  return window;
}

void draw_map(Raster& map, const ViewScene& scene, const Window& window) {
  const auto z = scene.grid.lattice().key(scene.pose.position.z()).value();
  for (int x = window.min_x; x <= window.max_x; ++x)
    for (int y = window.min_y; y <= window.max_y; ++y) {
      const Occupancy state =
          scene.grid.at({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y), z});
      const Color color = state == Occupancy::kFree       ? kFree
                          : state == Occupancy::kOccupied ? kOccupied
                                                          : kUnknown;
      map.fill(window.pixel_x(x), window.pixel_y(y), window.scale, window.scale, color);
    }
}

// Half way to what is free.
Color pale(Color color) {
  const auto mixed = [](int a, int b) { return static_cast<std::uint8_t>((a + b) / 2); };
  return {mixed(color.red, kFree.red), mixed(color.green, kFree.green), mixed(color.blue, kFree.blue)};
}

// The best quality of each column of voxels, -1 where there is no cell.
std::vector<double> columns_of(const ViewScene& scene, const Window& window) {
  std::vector<double> columns(window.place(window.max_x, window.max_y) + 1, -1.0);
  const int edge = scene.cell_edge;
  for (const auto& cell : scene.cells) {
    const int low_x = cell.cell.x - cell.cell.x % edge, low_y = cell.cell.y - cell.cell.y % edge;
    for (int x = std::max(low_x, window.min_x); x < low_x + edge && x <= window.max_x; ++x)
      for (int y = std::max(low_y, window.min_y); y < low_y + edge && y <= window.max_y; ++y) {
        double& best = columns[window.place(x, y)];
        best = std::max(best, cell.quality);
      }
  }
  return columns;
}

// On a scale of square roots, so that low qualities, which are far away, stay visible.
double fraction_of(double quality, double most) { return most > 0.0 ? std::sqrt(quality / most) : 0.0; }

void draw_cells(Raster& map, const ViewScene& scene, const Window& window, double most) {
  const std::vector<double> columns = columns_of(scene, window);
  const auto quality = [&](int x, int y) { return columns[window.place(x, y)]; };
  for (int x = window.min_x; x <= window.max_x; ++x)
    for (int y = window.min_y; y <= window.max_y; ++y)
      if (quality(x, y) >= 0.0)
        map.fill(window.pixel_x(x), window.pixel_y(y), window.scale, window.scale,
                 color_of(fraction_of(quality(x, y), most)));
  // Frontiers of all heights, those far above or below faintly, and none over cells.
  const int inset = window.scale >= 5 ? window.scale / 5 : 0;
  const int layer = scene.grid.lattice().key(scene.pose.position.z()).value();
  for (const bool near : {false, true})
    for (const VoxelKey& key : scene.frontiers)
      if (near == (std::abs(key.z - layer) <= 1) && quality(key.x, key.y) < 0.0)
        map.fill(window.pixel_x(key.x) + inset, window.pixel_y(key.y) + inset, window.scale - 2 * inset,
                 window.scale - 2 * inset, near ? frontier_color() : pale(frontier_color()));
}

Spot spot_of(const ViewScene& scene, const Window& window, const Eigen::Vector3d& point) {
  const double resolution = scene.grid.resolution();
  return {window.left + (point.x() / resolution + Lattice::kOrigin - window.min_x) * window.scale,
          window.top + (window.max_y + 1 - point.y() / resolution - Lattice::kOrigin) * window.scale};
}

// In reports and stills as well.
Color color_everywhere(const planner::Robot& robot) { return robot_colors({{robot}}).front(); }

void draw_robot_mark(Picture& picture, const Spot& at, Color color) {
  picture.disc(at, 9, kInk);
  picture.disc(at, 7, kPaper);
  picture.disc(at, 5, color);
}

void draw_goal_mark(Picture& picture, const Spot& at, Color color) {
  picture.ring(at, 10, 7, kPaper);
  picture.ring(at, 10, 4, color);
  picture.disc(at, 4.5, kPaper);
  picture.disc(at, 3, color);
}

void draw_robot_and_goal(Picture& picture, const ViewScene& scene, const Window& window) {
  const Color color = color_everywhere(scene.robot);
  draw_robot_mark(picture, spot_of(scene, window, scene.pose.position), color);
  if (!scene.goal.pose) return;
  const Spot goal = spot_of(scene, window, scene.goal.pose->position);
  const FieldOfView& view = scene.robot.view;
  const auto ray = [&](double yaw, double length, double thickness) {
    const double px = length / scene.grid.resolution() * window.scale;
    const std::array<Spot, 2> ends = {goal, {goal.x + px * std::cos(yaw), goal.y - px * std::sin(yaw)}};
    picture.line(ends, thickness + 2.5, kPaper);
    picture.line(ends, thickness, color);
  };
  if (view.shape != FieldOfView::Shape::kSpinning) {
    const double length = 0.35 * view.max_range;
    ray(scene.goal.pose->yaw - view.horizontal / 2, length, 2.5);
    ray(scene.goal.pose->yaw + view.horizontal / 2, length, 2.5);
  }
  draw_goal_mark(picture, goal, color);
}

void draw_panel(Picture& picture, const ViewScene& scene, const Window& window, int left, int height,
                double most) {
  constexpr int kBar = 28, kBarHeight = 300;
  picture.text({static_cast<double>(left), window.top + 5.0}, "view quality", kText);
  const int top = window.top + kLine;
  Raster bar(kBar, kBarHeight);
  for (int y = 0; y < kBarHeight; ++y) bar.fill(0, y, kBar, 1, color_of(1.0 - y / (kBarHeight - 1.0)));
  picture.image(left, top, std::move(bar));
  picture.frame(left - 1, top - 1, kBar + 2, kBarHeight + 2, 1, kInk);
  for (int tick = 0; tick <= 4; ++tick) {
    const int y = top + (kBarHeight - 1) * (4 - tick) / 4;
    picture.fill(left + kBar, y, 6, 1, kInk);
    picture.text({left + kBar + 12.0, y + 0.5}, short_number(most * tick * tick / 16), kText);
  }
  int y = top + kBarHeight + kMargin;
  const auto entry = [&](const char* name, const auto& draw) {
    draw(left + 10, y + 9);
    picture.text({left + 32.0, y + 9.0}, name, kText);
    y += kLine;
  };
  const auto patch = [&](Color color) {
    return [&picture, color](int x, int middle) {
      picture.fill(x - 9, middle - 9, 18, 18, color);
      picture.frame(x - 9, middle - 9, 18, 18, 1, kInk);
    };
  };
  entry("unknown", patch(kUnknown));
  entry("free", patch(kFree));
  entry("occupied", patch(kOccupied));
  entry("frontier", patch(frontier_color()));
  entry("frontier above, below", patch(pale(frontier_color())));
  const Color color = color_everywhere(scene.robot);
  entry("robot", [&](int x, int middle) { draw_robot_mark(picture, {double(x), double(middle)}, color); });
  entry("goal", [&](int x, int middle) { draw_goal_mark(picture, {double(x), double(middle)}, color); });

  const double metres_per_pixel = scene.grid.resolution() / window.scale;
  const double length = round_length((kPanel - kMargin - 40) * metres_per_pixel);
  const int pixels = static_cast<int>(std::lround(length / metres_per_pixel));
  const int bar_y = std::max(y + kMargin, std::min(height - kMargin - 8, y + 3 * kMargin));
  picture.fill(left, bar_y, pixels, 4, kInk);
  picture.fill(left, bar_y - 6, 2, 16, kInk);
  picture.fill(left + pixels - 2, bar_y - 6, 2, 16, kInk);
  picture.text({static_cast<double>(left), bar_y - 18.0}, short_number(length) + " m", kText);
}

}  // namespace

Picture draw_view(const ViewScene& scene) {
  constexpr int kPanelHeight = 660;
  const Window window = choose_window(scene);
  const int map_width = window.columns() * window.scale, map_height = window.rows() * window.scale;
  double title_width = 0.0;
  for (const std::string& line : scene.title)
    title_width = std::max(title_width, Picture(1, 1).text_width(line, kText));
  const int width = std::max(3 * kMargin + map_width + kPanel,
                             std::max(kWidth, 2 * kMargin + static_cast<int>(std::ceil(title_width))));
  const int height = window.top + std::max(map_height, kPanelHeight) + kMargin;
  Picture picture(width, height);
  for (std::size_t i = 0; i < scene.title.size(); ++i)
    picture.text({kMargin, kMargin + kLine * (static_cast<double>(i) + 0.4)}, scene.title[i], kText);
  double most = 0.0;
  for (const auto& cell : scene.cells) most = std::max(most, cell.quality);
  Raster map(map_width, map_height);
  draw_map(map, scene, window);
  draw_cells(map, scene, window, most);
  picture.image(window.left, window.top, std::move(map));
  picture.frame(window.left - 1, window.top - 1, map_width + 2, map_height + 2, 1, kInk);
  draw_robot_and_goal(picture, scene, window);
  draw_panel(picture, scene, window, window.left + map_width + kMargin, height, most);
  return picture;
}

}  // namespace frontlux::app
