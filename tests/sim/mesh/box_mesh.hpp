#pragma once

#include "support/test.hpp"

#include <frontlux/sim/world.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace frontlux::sim::test {

/// Two triangles with a diagonal from a to c.
inline void add_quad(TriangleMesh& mesh, const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                     const Eigen::Vector3f& c, const Eigen::Vector3f& d) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {a, b, c, d});
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

/// The six sides of a box, each of them in `pieces` x `pieces` quads, which face outwards.
inline void add_box(TriangleMesh& mesh, const Eigen::AlignedBox3f& box, int pieces = 1) {
  const auto line = [&](int axis, int number) {
    if (number == pieces) return box.max()[axis];
    return box.min()[axis] +
           (box.max()[axis] - box.min()[axis]) * static_cast<float>(number) / static_cast<float>(pieces);
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const int side : {0, pieces})
      for (int i = 0; i < pieces; ++i)
        for (int j = 0; j < pieces; ++j) {
          const auto corner = [&](int a, int b) {
            Eigen::Vector3f point;
            point[axis] = line(axis, side);
            point[u] = line(u, a);
            point[v] = line(v, b);
            return point;
          };
          const Eigen::Vector3f along_u = corner(i + 1, j), along_v = corner(i, j + 1);
          add_quad(mesh, corner(i, j), side == 0 ? along_v : along_u, corner(i + 1, j + 1),
                   side == 0 ? along_u : along_v);
        }
  }
}

inline TriangleMesh box_mesh(const Eigen::AlignedBox3f& box, int pieces = 1) {
  TriangleMesh mesh;
  add_box(mesh, box, pieces);
  return mesh;
}

}  // namespace frontlux::sim::test
