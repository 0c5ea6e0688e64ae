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

// The coordinates between which nothing changes.
class Cuts {
 public:
  void add(Span span) { lines_.insert(lines_.end(), {span.from, span.to}); }
  void finish() {
    std::sort(lines_.begin(), lines_.end());
    lines_.erase(std::unique(lines_.begin(), lines_.end()), lines_.end());
  }
  [[nodiscard]] int cells() const { return std::max(0, static_cast<int>(lines_.size()) - 1); }
  [[nodiscard]] int line(std::int32_t i) const { return lines_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] Span cells_of(Span span) const { return {index(span.from), index(span.to)}; }

 private:
  [[nodiscard]] int index(int line) const {
    return static_cast<int>(std::lower_bound(lines_.begin(), lines_.end(), line) - lines_.begin());
  }
  std::vector<int> lines_;
};

}  // namespace

void Solid::mirror(const Rect& frame, bool x, bool y) {
  for (auto& step : steps_) {
    if (x) step.x = step.x.mirrored(frame.x);
    if (y) step.y = step.y.mirrored(frame.y);
  }
}

TriangleMesh Solid::surface() const {
  std::array<Cuts, 3> cuts;
  for (const auto& [x, y, z, add] : steps_) {
    cuts[0].add(x);
    cuts[1].add(y);
    cuts[2].add(z);
  }
  for (auto& axis : cuts) axis.finish();
  const std::array<int, 3> cells = {cuts[0].cells(), cuts[1].cells(), cuts[2].cells()};
  const auto index = [&](int x, int y, int z) {
    return (static_cast<std::size_t>(x) * static_cast<std::size_t>(cells[1]) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(cells[2]) +
           static_cast<std::size_t>(z);
  };
  std::vector<std::uint8_t> solid(index(cells[0], 0, 0));
  for (const auto& step : steps_) {
    const Span xs = cuts[0].cells_of(step.x), ys = cuts[1].cells_of(step.y), zs = cuts[2].cells_of(step.z);
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
    return static_cast<float>(place(axis, cuts[static_cast<std::size_t>(axis)].line(line)));
  });
}

Eigen::Vector3d metres(const Eigen::Vector3i& p) {
  return {place(0, p.x()), place(1, p.y()), place(2, p.z())};
}

}  // namespace frontlux::sim
