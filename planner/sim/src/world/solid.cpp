#include "world/solid.hpp"

#include "world/cell_surface.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace frontlux::sim {
namespace {

constexpr std::array kOffset = {0.04, 0.04, -0.05};  // [m]

double place(int axis, int decimetres) {
  return static_cast<double>(decimetres) / 10.0 + kOffset[static_cast<std::size_t>(axis)];
}

}  // namespace

void Solid::mirror(const Rect& frame, bool x, bool y) {
  for (auto& step : steps_) {
    if (x) step.x = step.x.mirrored(frame.x);
    if (y) step.y = step.y.mirrored(frame.y);
  }
}

TriangleMesh Solid::surface() const {
  std::array<std::vector<int>, 3> lines;  // between which nothing changes
  for (const auto& [x, y, z, add] : steps_) {
    lines[0].insert(lines[0].end(), {x.from, x.to});
    lines[1].insert(lines[1].end(), {y.from, y.to});
    lines[2].insert(lines[2].end(), {z.from, z.to});
  }
  std::array<int, 3> cells{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<int>& some = lines[axis];
    std::sort(some.begin(), some.end());
    some.erase(std::unique(some.begin(), some.end()), some.end());
    cells[axis] = std::max(0, static_cast<int>(some.size()) - 1);
  }
  const auto cells_of = [&](std::size_t axis, const Span& span) {
    const auto place = [&some = lines[axis]](int line) {
      return static_cast<int>(std::lower_bound(some.begin(), some.end(), line) - some.begin());
    };
    return Span{place(span.from), place(span.to)};
  };
  const auto index = [&](int x, int y, int z) {
    return (static_cast<std::size_t>(x) * static_cast<std::size_t>(cells[1]) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(cells[2]) +
           static_cast<std::size_t>(z);
  };
  std::vector<std::uint8_t> solid(index(cells[0], 0, 0));
  for (const auto& step : steps_) {
    const Span xs = cells_of(0, step.x), ys = cells_of(1, step.y), zs = cells_of(2, step.z);
    for (int x = xs.from; x < xs.to; ++x)
      for (int y = ys.from; y < ys.to; ++y)
        for (int z = zs.from; z < zs.to; ++z) solid[index(x, y, z)] = step.add ? 1 : 0;
  }
  const auto is_solid = [&](const std::array<int, 3>& c) {
    for (std::size_t i = 0; i < 3; ++i)
      if (c[i] < 0 || c[i] >= cells[i]) return false;
    return solid[index(c[0], c[1], c[2])] != 0;
  };
  CellFaces faces;
  std::array<int, 3> c{};
  for (c[0] = 0; c[0] < cells[0]; ++c[0])
    for (c[1] = 0; c[1] < cells[1]; ++c[1])
      for (c[2] = 0; c[2] < cells[2]; ++c[2]) {
        if (!is_solid(c)) continue;
        for (std::size_t axis = 0; axis < 3; ++axis)
          for (const int side : {0, 1}) {
            auto next = c;
            next[axis] += side == 0 ? -1 : 1;
            if (!is_solid(next))
              faces[axis][static_cast<std::size_t>(side)].push_back(
                  {c[axis] + side, c[(axis + 1) % 3], c[(axis + 2) % 3]});
          }
      }
  return mesh_of(std::move(faces), [&](int axis, std::int32_t line) {
    return static_cast<float>(
        place(axis, lines[static_cast<std::size_t>(axis)][static_cast<std::size_t>(line)]));
  });
}

Eigen::Vector3d metres(const Eigen::Vector3i& p) {
  return {place(0, p.x()), place(1, p.y()), place(2, p.z())};
}

}  // namespace frontlux::sim
