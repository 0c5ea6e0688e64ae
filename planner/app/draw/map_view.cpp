#include "draw/map_view.hpp"

#include "draw/colors.hpp"
#include "draw/round_length.hpp"
#include "text.hpp"

#include <frontlux/key_box.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace frontlux::app {
namespace {

constexpr Color kLow{86, 106, 140}, kMiddle{172, 178, 176}, kHigh{233, 220, 180};
constexpr int kMargin = 28, kLine = 34;
constexpr int kFooter = 130;  // [px] for the keys below the map
constexpr TextStyle kTitle{.size = 26.0, .color = kInk, .bold = true}, kText{.size = 22.0, .color = kInk},
    kName{.size = 22.0, .color = kInk, .bold = true, .halo = true};

// Seen from 18 degrees aside and 48 degrees above the ground; y and x point away from the viewer.
struct Projection {
  double sin_turn = std::sin(18.0 * std::numbers::pi / 180.0),
         cos_turn = std::cos(18.0 * std::numbers::pi / 180.0);
  double sin_rise = std::sin(48.0 * std::numbers::pi / 180.0),
         cos_rise = std::cos(48.0 * std::numbers::pi / 180.0);
  double scale = 1.0, left = 0.0, top = 0.0;  // [px] of a voxel; of the origin

  // A point in voxels.
  [[nodiscard]] Spot spot(const Eigen::Vector3d& p) const {
    const double away = p.x() * sin_turn + p.y() * cos_turn;
    return {left + scale * (p.x() * cos_turn - p.y() * sin_turn),
            top - scale * (p.z() * cos_rise + away * sin_rise)};
  }
  // Of what covers each other, the nearer has the greater one [voxels].
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

// The colour of a height, 0 to 1 of the map's.
Color height_color(double fraction) {
  return fraction < 0.5 ? mixed(kLow, kMiddle, 2 * fraction) : mixed(kMiddle, kHigh, 2 * fraction - 1);
}

Color face_color(const Face& face, double low, double high) {
  constexpr std::array<double, 3> kShade = {0.3, 0.18, 0.0};
  const double fraction = high > low ? std::clamp((face.middle.z() - low) / (high - low), 0.0, 1.0) : 0.0;
  return mixed(height_color(fraction), {0, 0, 0}, kShade.at(face.axis));
}

// The map's surface in pixels, and how near it is in each.
class Surface {
 public:
  // Of a picture, but so many times as fine.
  Surface(int width, int height, int fine, Projection projection)
      : fine_(fine),
        raster_(fine * width, fine * height),
        nearest_(raster_.pixels().size(), std::numeric_limits<float>::lowest()),
        projection_(projection) {
    projection_.scale *= fine;
    projection_.left *= fine;
    projection_.top *= fine;
  }

  // Pixels whose middle lies in the parallelogram of the face.
  void add(const Face& face, Color color) {
    const auto unit = [](std::size_t axis) {
      return Eigen::Vector3d(Eigen::Vector3d::Unit(static_cast<Eigen::Index>(axis)));
    };
    const Eigen::Vector3d u = 0.5 * unit((face.axis + 1) % 3), v = 0.5 * unit((face.axis + 2) % 3);
    const Spot middle = projection_.spot(face.middle), to_u = projection_.spot(face.middle + u),
               to_v = projection_.spot(face.middle + v);
    const double ux = to_u.x - middle.x, uy = to_u.y - middle.y, vx = to_v.x - middle.x,
                 vy = to_v.y - middle.y;
    const double area = ux * vy - uy * vx, reach_x = std::fabs(ux) + std::fabs(vx),
                 reach_y = std::fabs(uy) + std::fabs(vy);
    if (area == 0.0) return;
    const double near = projection_.nearness(face.middle),
                 near_u = projection_.nearness(face.middle + u) - near,
                 near_v = projection_.nearness(face.middle + v) - near;
    constexpr double kInside = 1.0 + 1e-9;
    for (int y = first(middle.y - reach_y); y <= last(middle.y + reach_y, raster_.height()); ++y)
      for (int x = first(middle.x - reach_x); x <= last(middle.x + reach_x, raster_.width()); ++x) {
        const double dx = x + 0.5 - middle.x, dy = y + 0.5 - middle.y;
        const double along_u = (dx * vy - dy * vx) / area, along_v = (ux * dy - uy * dx) / area;
        if (std::fabs(along_u) > kInside || std::fabs(along_v) > kInside) continue;
        const auto here = static_cast<float>(near + along_u * near_u + along_v * near_v);
        float& nearest = nearest_[place(x, y)];
        if (here <= nearest) continue;
        nearest = here;
        raster_.set(x, y, color);
      }
  }

  // Whether no face covers a point in voxels. What a face lies closer to than a voxel counts as in front of
  // it.
  [[nodiscard]] bool shows(const Eigen::Vector3d& point) const {
    const Spot spot = projection_.spot(point);
    if (!(spot.x >= 0.0 && spot.y >= 0.0 && spot.x < raster_.width() && spot.y < raster_.height()))
      return true;
    constexpr double kClose = 1.0;
    return nearest_[place(static_cast<int>(spot.x), static_cast<int>(spot.y))] <=
           projection_.nearness(point) + kClose;
  }

  [[nodiscard]] Raster raster() const { return raster_.reduced(fine_); }

 private:
  static int first(double pixel) { return std::max(0, static_cast<int>(std::floor(pixel))); }
  static int last(double pixel, int size) { return std::min(size - 1, static_cast<int>(std::ceil(pixel))); }
  [[nodiscard]] std::size_t place(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(raster_.width()) +
           static_cast<std::size_t>(x);
  }

  int fine_;
  Raster raster_;
  std::vector<float> nearest_;
  Projection projection_;
};

// Fits all faces and paths between the margins.
Projection fit(const std::vector<Eigen::Vector3d>& points, const MapView::Size& most, int header, int& width,
               int& height) {
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
  constexpr double kMaxScale = 24.0;
  projection.scale = std::min({most.width / (max_x - min_x), most.height / (max_y - min_y), kMaxScale});
  width = std::max(900, static_cast<int>(std::ceil(projection.scale * (max_x - min_x))) + 2 * kMargin);
  height = static_cast<int>(std::ceil(projection.scale * (max_y - min_y))) + 2 * kMargin + header + kFooter;
  width += width % 2;  // films have even edges
  height += height % 2;
  projection.left = (width - projection.scale * (max_x + min_x)) / 2;
  projection.top = kMargin + header - projection.scale * min_y;
  return projection;
}

// What is seen of a path: the pieces that no face covers.
std::vector<std::vector<Spot>> seen_pieces(const Surface& surface, const Projection& projection,
                                           const std::vector<Eigen::Vector3d>& path) {
  std::vector<std::vector<Spot>> pieces;
  bool seen = false;
  const auto add = [&](const Eigen::Vector3d& point) {
    if (!surface.shows(point)) {
      seen = false;
      return;
    }
    if (!seen) pieces.emplace_back();
    seen = true;
    pieces.back().push_back(projection.spot(point));
  };
  constexpr double kStep = 2.0, kMostSteps = 10000.0;  // [px]
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i > 0) {
      const Spot a = projection.spot(path[i - 1]), b = projection.spot(path[i]);
      const double steps = std::clamp(std::ceil(std::hypot(b.x - a.x, b.y - a.y) / kStep), 1.0, kMostSteps);
      for (double k = 1.0; k < steps; ++k) add(path[i - 1] + k / steps * (path[i] - path[i - 1]));
    }
    add(path[i]);
  }
  return pieces;
}

// Starts and ends stand above everything; the robot's name tells the paths of a grey print apart.
void draw_ends(Picture& picture, const Projection& projection, const std::vector<Eigen::Vector3d>& path,
               const std::string& name, Color color) {
  if (path.empty()) return;
  const Spot begin = projection.spot(path.front()), end = projection.spot(path.back());
  picture.disc(begin, 10, kPaper);
  picture.ring(begin, 6.5, 4, color);
  picture.disc(end, 12, kPaper);
  picture.disc(end, 9, color);
  const bool left = end.x < picture.width() - 150;
  picture.text({end.x + (left ? 18.0 : -18.0), end.y}, name,
               {kName.size, kName.color, left ? Align::kLeft : Align::kRight, kName.bold, kName.halo});
}

// What the colours of heights are.
void draw_height_key(Picture& picture, double y, double low, double high, double resolution) {
  constexpr int kBar = 240, kThick = 20;
  double x = kMargin;
  picture.text({x, y}, "height", kText);
  x += picture.text_width("height", kText) + 20;
  const std::string lowest = fixed(low * resolution, 1) + " m";
  picture.text({x, y}, lowest, kText);
  x += picture.text_width(lowest, kText) + 12;
  Raster bar(kBar, kThick);
  for (int i = 0; i < kBar; ++i) bar.fill(i, 0, 1, kThick, height_color(i / (kBar - 1.0)));
  picture.image(std::round(x), std::round(y) - kThick / 2.0, std::move(bar));
  picture.text({x + kBar + 12, y}, fixed(high * resolution, 1) + " m", kText);
}

// Three legs of the same length, since a length is drawn shorter the more it points at the viewer.
void draw_scale(Picture& picture, const Projection& projection, double resolution) {
  constexpr double kLongest = 160.0;  // [px]
  const double length = round_length(kLongest / projection.scale * resolution);
  const Spot origin = projection.spot(Eigen::Vector3d::Zero());
  const Spot corner{picture.width() - kMargin - kLongest - 20.0, picture.height() - kMargin - 10.0};
  constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};
  for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
    const Eigen::Vector3d leg = length / resolution * Eigen::Vector3d::Unit(static_cast<Eigen::Index>(axis));
    const Spot end = projection.spot(leg);
    const double x = end.x - origin.x, y = end.y - origin.y, size = std::hypot(x, y);
    const std::array<Spot, 2> line = {corner, {corner.x + x, corner.y + y}};
    picture.line(line, 3.0, kInk);
    picture.text({line[1].x + 14 * x / size, line[1].y + 14 * y / size}, kAxes[axis],
                 {.size = 18.0, .color = kMuted, .align = Align::kMiddle});
  }
  // Above the line of the heights, which in a small picture reaches so far.
  picture.text({corner.x - 60.0, corner.y - 8.0 - kLine}, short_number(length) + " m along each axis",
               {.size = kText.size, .color = kInk, .align = Align::kRight});
}

}  // namespace

struct MapView::State {
  // The surface of a map, which many frames of a film share.
  struct Drawn {
    VoxelGrid grid;
    Surface surface;
    Raster raster;
  };
  std::vector<std::string> names;
  std::vector<Color> colors;
  double resolution;
  int fine;
  int width = 0, height = 0;     // [px]
  double low = 0.0, high = 0.0;  // [voxels] of the map
  Projection projection;
  std::optional<Drawn> drawn;  // last
};

MapView::MapView(const planner::Recording& recording, const RunMap& all, const Size& most) {
  State state{.names = {},
              .colors = robot_colors(recording.head.robots),
              .resolution = recording.head.resolution,
              .fine = most.fine,
              .projection = {},
              .drawn = {}};
  for (const auto& description : recording.head.robots) state.names.push_back(description.robot.name);
  std::vector<Eigen::Vector3d> points;
  for (const Face& face : visible_faces(all.grid())) {
    state.low = points.empty() ? face.middle.z() : std::min(state.low, face.middle.z());
    state.high = points.empty() ? face.middle.z() : std::max(state.high, face.middle.z());
    points.push_back(face.middle);
  }
  for (const auto& path : all.paths()) points.insert(points.end(), path.begin(), path.end());
  const int header = kLine * (1 + static_cast<int>(state.names.size()));
  state.projection = fit(points, most, header, state.width, state.height);
  state_ = std::make_shared<State>(std::move(state));
}

Picture MapView::draw(const RunMap& map, const std::string& title) {
  auto& [names, colors, resolution, fine, width, height, low, high, projection, drawn] = *state_;
  if (!drawn || !(drawn->grid == map.grid())) {
    Surface surface(width, height, fine, projection);
    for (const Face& face : visible_faces(map.grid())) surface.add(face, face_color(face, low, high));
    Raster raster = surface.raster();
    drawn.emplace(State::Drawn{map.grid(), std::move(surface), std::move(raster)});
  }
  const Surface& surface = drawn->surface;
  Picture picture(width, height);
  picture.image(0, 0, drawn->raster);
  for (const auto& [thickness, halo] : {std::pair{8.0, true}, std::pair{4.5, false}})
    for (std::size_t r = 0; r < names.size(); ++r)
      for (const auto& piece : seen_pieces(surface, projection, map.paths()[r]))
        picture.line(piece, thickness, halo ? kPaper : colors[r]);
  for (std::size_t r = 0; r < names.size(); ++r)
    draw_ends(picture, projection, map.paths()[r], names[r], colors[r]);

  picture.text({kMargin, kMargin + 8.0}, title, kTitle);
  for (std::size_t r = 0; r < names.size(); ++r) {
    const double y = kMargin + 8.0 + kLine * (1.0 + static_cast<double>(r));
    const std::array<Spot, 2> sample = {Spot{kMargin + 3.0, y}, Spot{kMargin + 40.0, y}};
    picture.line(sample, 6.0, colors[r]);
    picture.text({kMargin + 56.0, y}, names[r] + ", " + fixed(map.lengths()[r], 0) + " m", kText);
  }
  const double below = height - kMargin - 18.0;
  draw_height_key(picture, below, low, high, resolution);
  picture.ring({kMargin + 10.0, below - kLine}, 6.5, 4, kMuted);
  picture.text({kMargin + 28.0, below - kLine}, "start", kText);
  picture.disc({kMargin + 120.0, below - kLine}, 9, kMuted);
  picture.text({kMargin + 138.0, below - kLine}, map.at_end() ? "end" : "robot", kText);
  draw_scale(picture, projection, resolution);
  return picture;
}

}  // namespace frontlux::app
