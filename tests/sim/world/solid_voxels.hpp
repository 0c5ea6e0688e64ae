#pragma once

#include "support/test.hpp"

#include <frontlux/sim/world.hpp>

namespace frontlux::test {

/// Which voxels of a world a robot cannot be in: those that a triangle touches, by the separating axis test,
/// and those whose centre lies inside a closed surface, by the surfaces above it. Nothing in common with how
/// the worlds are made.
class SolidVoxels {
 public:
  using Cell = std::array<int, 3>;

  SolidVoxels(const sim::World& world, double resolution) : resolution_(resolution) {
    for (int i = 0; i < 3; ++i) {
      low_[at(i)] = cell(world.bounds.min()[i]) - 1;
      size_[at(i)] = cell(world.bounds.max()[i]) + 2 - low_[at(i)];
    }
    solid_.resize(at(size_[0]) * at(size_[1]) * at(size_[2]));
    above_.resize(at(size_[0]) * at(size_[1]));
    for (std::size_t i = 0; i < world.mesh.triangles.size(); ++i) {
      touch(sim::corners_of(world.mesh, i));
      note_column(sim::corners_of(world.mesh, i));
    }
    fill_insides();
  }

  [[nodiscard]] const Cell& size() const { return size_; }
  [[nodiscard]] int cell(double coordinate) const {
    return static_cast<int>(std::floor(coordinate / resolution_));
  }
  /// Index into this of the voxel that holds a point.
  [[nodiscard]] Cell local(const Eigen::Vector3d& p) const {
    return {cell(p.x()) - low_[0], cell(p.y()) - low_[1], cell(p.z()) - low_[2]};
  }
  [[nodiscard]] double center_z(int z) const { return (z + low_[2] + 0.5) * resolution_; }
  [[nodiscard]] bool solid(const Cell& c) const {
    for (std::size_t i = 0; i < 3; ++i)
      if (c[i] < 0 || c[i] >= size_[i]) return true;
    return solid_[index(c)] != 0;
  }
  /// All, or none, of the voxels from `low` to `high` are solid.
  [[nodiscard]] bool all_solid(const Cell& low, const Cell& high) const { return all_are(true, low, high); }
  [[nodiscard]] bool free(const Cell& low, const Cell& high) const { return all_are(false, low, high); }

 private:
  using Triangle = std::array<Eigen::Vector3d, 3>;
  struct Crossing {
    double z;
    int sign;  // 1 if the surface faces up
  };

  [[nodiscard]] bool all_are(bool state, const Cell& low, const Cell& high) const {
    for (int x = low[0]; x <= high[0]; ++x)
      for (int y = low[1]; y <= high[1]; ++y)
        for (int z = low[2]; z <= high[2]; ++z)
          if (solid({x, y, z}) != state) return false;
    return true;
  }
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  [[nodiscard]] std::size_t index(const Cell& c) const {
    return (at(c[0]) * at(size_[1]) + at(c[1])) * at(size_[2]) + at(c[2]);
  }
  [[nodiscard]] Eigen::Vector3d center(const Cell& c) const {
    return {(c[0] + low_[0] + 0.5) * resolution_, (c[1] + low_[1] + 0.5) * resolution_, center_z(c[2])};
  }

  static bool separated(const Triangle& t, const Eigen::Vector3d& axis, double half) {
    const double a = t[0].dot(axis), b = t[1].dot(axis), c = t[2].dot(axis);
    const double reach = half * axis.cwiseAbs().sum();
    return std::min({a, b, c}) > reach || std::max({a, b, c}) < -reach;
  }

  static bool touches(Triangle t, const Eigen::Vector3d& center, double half) {
    for (auto& p : t) p -= center;
    const std::array<Eigen::Vector3d, 3> side = {t[1] - t[0], t[2] - t[1], t[0] - t[2]};
    if (separated(t, side[0].cross(side[1]), half)) return false;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d axis = Eigen::Vector3d::Unit(i);
      if (separated(t, axis, half)) return false;
      for (const auto& s : side)
        if (separated(t, axis.cross(s), half)) return false;
    }
    return true;
  }

  void touch(const Triangle& t) {
    Eigen::AlignedBox3d box;
    for (const auto& p : t) box.extend(p);
    const Cell low = local(box.min()), high = local(box.max());
    for (int x = low[0]; x <= high[0]; ++x)
      for (int y = low[1]; y <= high[1]; ++y)
        for (int z = low[2]; z <= high[2]; ++z)
          if (touches(t, center({x, y, z}), resolution_ / 2)) solid_[index({x, y, z})] = 1;
  }

  void note_column(const Triangle& t) {
    Eigen::AlignedBox3d box;
    for (const auto& p : t) box.extend(p);
    const Cell low = local(box.min()), high = local(box.max());
    for (int x = low[0]; x <= high[0]; ++x)
      for (int y = low[1]; y <= high[1]; ++y) {
        // Beside the centre, where no side of a triangle runs.
        const Eigen::Vector3d p = center({x, y, 0}) + Eigen::Vector3d(0.00371, 0.00113, 0.0);
        std::array<double, 3> share{};
        for (std::size_t i = 0; i < 3; ++i) {
          const Eigen::Vector3d a = t[i] - p, b = t[(i + 1) % 3] - p;
          share[(i + 2) % 3] = a.x() * b.y() - a.y() * b.x();
        }
        const bool up = share[0] > 0 && share[1] > 0 && share[2] > 0;
        const bool down = share[0] < 0 && share[1] < 0 && share[2] < 0;
        if (!up && !down) continue;
        const double all = share[0] + share[1] + share[2];
        const double z = (share[0] * t[0].z() + share[1] * t[1].z() + share[2] * t[2].z()) / all;
        above_[at(x) * at(size_[1]) + at(y)].push_back({z, up ? 1 : -1});
      }
  }

  void fill_insides() {
    for (int x = 0; x < size_[0]; ++x)
      for (int y = 0; y < size_[1]; ++y)
        for (int z = 0; z < size_[2]; ++z) {
          int depth = 0;
          for (const auto& crossing : above_[at(x) * at(size_[1]) + at(y)])
            if (crossing.z > center_z(z)) depth += crossing.sign;
          if (depth != 0) solid_[index({x, y, z})] = 1;
        }
  }

  double resolution_;
  Cell low_{}, size_{};
  std::vector<char> solid_;
  std::vector<std::vector<Crossing>> above_;
};

}  // namespace frontlux::test
