#include "world/cell_surface.hpp"

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <utility>

namespace frontlux::sim {
namespace {

using Lines = std::array<std::int32_t, 3>;  // a lattice point, by axis

struct Rectangle {
  std::int32_t plane, u0, u1, v0, v1;
};

std::vector<Rectangle> rectangles_of(std::vector<CellFace>& faces) {
  std::sort(faces.begin(), faces.end(), [](const CellFace& a, const CellFace& b) {
    return std::tie(a.plane, a.v, a.u) < std::tie(b.plane, b.v, b.u);
  });
  std::vector<Rectangle> runs;
  for (const auto& [plane, u, v] : faces) {
    if (!runs.empty() && runs.back().plane == plane && runs.back().v0 == v && runs.back().u1 == u)
      ++runs.back().u1;
    else
      runs.push_back({plane, u, u + 1, v, v + 1});
  }
  std::sort(runs.begin(), runs.end(), [](const Rectangle& a, const Rectangle& b) {
    return std::tie(a.plane, a.u0, a.u1, a.v0) < std::tie(b.plane, b.u0, b.u1, b.v0);
  });
  std::vector<Rectangle> merged;
  for (const auto& run : runs) {
    const bool joins = !merged.empty() &&
                       std::tie(merged.back().plane, merged.back().u0, merged.back().u1, merged.back().v1) ==
                           std::tie(run.plane, run.u0, run.u1, run.v0);
    if (joins)
      merged.back().v1 = run.v1;
    else
      merged.push_back(run);
  }
  return merged;
}

Lines point_of(int axis, std::int32_t plane, std::int32_t u, std::int32_t v) {
  Lines p{};
  p[static_cast<std::size_t>(axis)] = plane;
  p[static_cast<std::size_t>((axis + 1) % 3)] = u;
  p[static_cast<std::size_t>((axis + 2) % 3)] = v;
  return p;
}

// The corners in order around the rectangle, counter-clockwise where the axis comes towards the eye.
std::array<Lines, 4> corners_of(int axis, const Rectangle& r) {
  return {point_of(axis, r.plane, r.u0, r.v0), point_of(axis, r.plane, r.u1, r.v0),
          point_of(axis, r.plane, r.u1, r.v1), point_of(axis, r.plane, r.u0, r.v1)};
}

// The corners of all rectangles, and which of them lie on a line between two of them.
class Corners {
 public:
  explicit Corners(std::vector<Lines> points) : points_(std::move(points)) {
    std::sort(points_.begin(), points_.end());
    points_.erase(std::unique(points_.begin(), points_.end()), points_.end());
    for (std::size_t axis = 0; axis < 3; ++axis) {
      auto& row = rows_[axis];
      row.reserve(points_.size());
      for (std::uint32_t i = 0; i < points_.size(); ++i) row.emplace_back(along(axis, points_[i]), i);
      std::sort(row.begin(), row.end());
    }
  }

  [[nodiscard]] const std::vector<Lines>& points() const { return points_; }

  // Appends the corners from `from`, included, to `to`, left out. @pre they differ along one axis
  void append_side(const Lines& from, const Lines& to, std::vector<std::uint32_t>& loop) const {
    std::size_t axis = 0;
    while (from[axis] == to[axis]) ++axis;
    const auto& row = rows_[axis];
    const auto find = [&](const Lines& p) {
      return std::lower_bound(row.begin(), row.end(), std::pair(along(axis, p), std::uint32_t{0}));
    };
    auto at = find(from);
    for (const auto end = find(to); at != end; from[axis] < to[axis] ? ++at : --at)
      loop.push_back(at->second);
  }

 private:
  static Lines along(std::size_t axis, const Lines& p) {
    return {p[(axis + 1) % 3], p[(axis + 2) % 3], p[axis]};
  }

  std::vector<Lines> points_;
  std::array<std::vector<std::pair<Lines, std::uint32_t>>, 3> rows_;
};

}  // namespace

TriangleMesh mesh_of(CellFaces faces, const std::function<float(int axis, std::int32_t line)>& coordinate) {
  std::array<std::array<std::vector<Rectangle>, 2>, 3> rectangles;
  std::vector<Lines> points;
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t side = 0; side < 2; ++side) {
      auto& some = rectangles[static_cast<std::size_t>(axis)][side];
      some = rectangles_of(faces[static_cast<std::size_t>(axis)][side]);
      for (const auto& rectangle : some)
        for (const auto& corner : corners_of(axis, rectangle)) points.push_back(corner);
    }
  const Corners corners(std::move(points));

  TriangleMesh mesh;
  mesh.vertices.reserve(corners.points().size());
  for (const auto& [x, y, z] : corners.points())
    mesh.vertices.emplace_back(coordinate(0, x), coordinate(1, y), coordinate(2, z));
  std::vector<std::uint32_t> loop;
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t side = 0; side < 2; ++side)
      for (const auto& rectangle : rectangles[static_cast<std::size_t>(axis)][side]) {
        const auto corner = corners_of(axis, rectangle);
        loop.clear();
        for (std::size_t i = 0; i < 4; ++i) corners.append_side(corner[i], corner[(i + 1) % 4], loop);
        if (side == 0) std::reverse(loop.begin(), loop.end());
        if (loop.size() == 4) {
          mesh.triangles.push_back({loop[0], loop[1], loop[2]});
          mesh.triangles.push_back({loop[0], loop[2], loop[3]});
          continue;
        }
        // Three of the points may lie on one line, but none of them on one with the centre.
        const auto centre = static_cast<std::uint32_t>(mesh.vertices.size());
        Eigen::Vector3f middle;
        for (int i = 0; i < 3; ++i) {
          const auto k = static_cast<std::size_t>(i);
          middle[i] = 0.5F * (coordinate(i, corner[0][k]) + coordinate(i, corner[2][k]));
        }
        mesh.vertices.push_back(middle);
        for (std::size_t i = 0; i < loop.size(); ++i)
          mesh.triangles.push_back({centre, loop[i], loop[(i + 1) % loop.size()]});
      }
  return mesh;
}

}  // namespace frontlux::sim
