#pragma once

#include <frontlux/export.hpp>
#include <frontlux/key_box.hpp>
#include <frontlux/lattice.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace frontlux::planner {

/// The voxels that a segment enters, or that a small box enters as it moves along the segment.
///
/// Along each axis voxels count as wider than they are by a billionth on both sides, more than all rounding,
/// so that none is missed that the segment touches. So at an edge or corner all voxels that meet there count.
/// Along an axis none count beyond those that hold the ends, so of a segment that lies in a face only the
/// voxels of one side count: those that hold its points, since voxels are half open.
class FRONTLUX_EXPORT SegmentVoxels {
 public:
  /// @param from, to  [m]
  /// @param reach  [m] of the box to each side of its middle, which moves from `from` to `to`
  SegmentVoxels(const Lattice& lattice, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                const Eigen::Vector3d& reach = Eigen::Vector3d::Zero()) {
    for (std::size_t a = 0; a < 3; ++a) {
      const auto i = static_cast<Eigen::Index>(a);
      const auto first = lattice.key(std::min(from[i], to[i]) - reach[i]),
                 last = lattice.key(std::max(from[i], to[i]) + reach[i]);
      if (!first || !last || std::isnan(from[i]) || std::isnan(to[i])) {
        inside_ = false;
        return;
      }
      Axis& axis = axes_[a];
      axis.low = *first;
      axis.high = *last;
      axis.widen = kWiden + reach[i] / lattice.resolution();
      axis.start = from[i] / lattice.resolution() + Lattice::kOrigin;
      axis.length = (to[i] - from[i]) / lattice.resolution();
    }
  }

  /// Whether `holds(key)` for every voxel; calls it no more after the first for which it does not. False if
  /// an end is not finite or beyond the key range.
  template <class Holds>
  [[nodiscard]] bool all_of(const Holds& holds) const {
    return inside_ && axes_[0].for_each({0.0, 1.0}, [&](int x, const Part& in_x) {
      return axes_[1].for_each(in_x, [&](int y, const Part& in_xy) {
        return axes_[2].for_each(in_xy, [&](int z, const Part&) { return holds(make_key(x, y, z)); });
      });
    });
  }

  /// Calls `visit(key)` for every voxel; for none if an end is not finite or beyond the key range.
  template <class Visit>
  void for_each(const Visit& visit) const {
    static_cast<void>(all_of([&visit](const VoxelKey& key) { return visit(key), true; }));
  }

 private:
  static constexpr double kWiden = 1e-9;  // [voxels] rounding is below 1e-10, with keys of up to 65535

  struct Part {
    double begin, end;  // of the segment, 0 to 1
  };

  struct Axis {
    int low = 0, high = 0;                             // voxels of the ends
    double start = 0.0, length = 0.0, widen = kWiden;  // [voxels]

    // Calls `visit(voxel, part of the segment in it)` until it returns false.
    template <class Visit>
    [[nodiscard]] bool for_each(const Part& part, const Visit& visit) const {
      if (low == high) return visit(low, part);
      const double a = start + part.begin * length, b = start + part.end * length;
      const auto voxel = [this](double at) {
        return static_cast<int>(
            std::clamp(std::floor(at), static_cast<double>(low), static_cast<double>(high)));
      };
      const int last = voxel(std::max(a, b) + widen);
      for (int k = voxel(std::min(a, b) - widen); k <= last; ++k) {
        if (length == 0.0) {
          if (!visit(k, part)) return false;
          continue;
        }
        const double lower = (k - widen - start) / length, upper = (k + 1 + widen - start) / length;
        const Part in{std::max(part.begin, std::min(lower, upper)),
                      std::min(part.end, std::max(lower, upper))};
        if (in.begin <= in.end && !visit(k, in)) return false;
      }
      return true;
    }
  };

  std::array<Axis, 3> axes_;
  bool inside_ = true;
};

}  // namespace frontlux::planner
