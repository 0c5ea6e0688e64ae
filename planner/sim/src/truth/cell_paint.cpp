#include "truth/cell_paint.hpp"

#include "mesh/triangle_overlap.hpp"

#include <frontlux/parallel.hpp>

#include <algorithm>
#include <stdexcept>

namespace frontlux::sim {
namespace {

using Cell = Eigen::Vector3<std::int64_t>;

// The cells from `low` to `high`, both included. Empty if some low is above its high.
struct Block {
  Cell low, high;
};

class Painter {
 public:
  Painter(const TriangleMesh& mesh, const CellFrame& frame, std::vector<std::uint8_t>& cells)
      : frame_(frame), cells_(cells) {
    triangles_.reserve(mesh.triangles.size());
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) triangles_.emplace_back(corners_of(mesh, i));
  }

  // About how many cells will be looked at, a cell once for each triangle: those of its area or of its
  // longest side, and no more than there are along one side of its bounds.
  [[nodiscard]] double work(const TriangleMesh& mesh) const {
    double all = 0.0;
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      const auto corners = corners_of(mesh, i);
      const double area = (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm() / 2;
      const Block reach = reach_of(triangles_[i]);
      const Eigen::Array3d size = (reach.high - reach.low).cast<double>().array() + 1.0;
      all += std::min(std::max(area / (frame_.edge * frame_.edge), size.maxCoeff()),
                      size.prod() / size.minCoeff());
    }
    return all;
  }

  // All triangles, in one slab of cells: slabs share no cell, so each may have its own thread.
  void paint_slab(const Block& slab) {
    for (const TriangleOverlap& triangle : triangles_) {
      const Block reach = reach_of(triangle);
      const Block block{reach.low.cwiseMax(slab.low), reach.high.cwiseMin(slab.high)};
      if ((block.low.array() <= block.high.array()).all()) paint(triangle, block);
    }
  }

 private:
  // The cells that the triangle's bounds meet. Beyond the frame by a cell at most, so that nothing overflows.
  [[nodiscard]] Block reach_of(const TriangleOverlap& triangle) const {
    const auto cell = [&](const Eigen::Vector3d& point) -> Cell {
      const Eigen::Array3d position = (point - frame_.corner).array() / frame_.edge;
      return position.floor().max(-1.0).min(frame_.size.cast<double>().array()).matrix().cast<std::int64_t>();
    };
    const Eigen::Vector3d room = Eigen::Vector3d::Constant(2 * frame_.margin);
    return {cell(triangle.bounds().min() - room), cell(triangle.bounds().max() + room)};
  }

  // Halves the block again and again, because most of a slanting triangle's bounds is not near it.
  void paint(const TriangleOverlap& triangle, const Block& block) {
    if (!triangle.touches(frame_.box(block.low, block.high, frame_.margin))) return;
    Eigen::Index axis = 0;
    if ((block.high - block.low).maxCoeff(&axis) == 0) return paint_cell(triangle, block.low);
    Block lower = block, upper = block;
    lower.high[axis] = (block.low[axis] + block.high[axis]) / 2;
    upper.low[axis] = lower.high[axis] + 1;
    paint(triangle, lower);
    paint(triangle, upper);
  }

  void paint_cell(const TriangleOverlap& triangle, const Cell& at) {
    std::uint8_t& flags =
        cells_[static_cast<std::size_t>((at.z() * frame_.size.y() + at.y()) * frame_.size.x() + at.x())];
    if ((flags & cell::kSolid) != 0) return;
    const Eigen::AlignedBox3d inside = frame_.box(at, at, -frame_.margin);
    if (triangle.touches(inside)) {
      flags = cell::kSolid;
      return;
    }
    for (int axis = 0; axis < 3; ++axis) {
      Eigen::AlignedBox3d face = inside;
      face.max()[axis] = face.min()[axis];
      face.min()[axis] -= 2 * frame_.margin;
      if (triangle.touches(face)) flags |= static_cast<std::uint8_t>(cell::kWallBelow << axis);
    }
  }

  const CellFrame& frame_;
  std::vector<std::uint8_t>& cells_;
  std::vector<TriangleOverlap> triangles_;
};

}  // namespace

void paint(const TriangleMesh& mesh, const CellFrame& frame, std::vector<std::uint8_t>& cells) {
  constexpr std::size_t kThickness = 16;
  constexpr double kMostWork = 1 << 30;
  Painter painter(mesh, frame, cells);
  if (painter.work(mesh) > kMostWork)
    throw std::invalid_argument(
        "the triangles of the mesh pass through more than 2^30 voxels, a voxel counted for each of them; "
        "leave out triangles that are there twice, or take larger voxels");
  Eigen::Index axis = 0;
  const std::int64_t length = frame.size.maxCoeff(&axis);
  for_each_chunk(static_cast<std::size_t>(length), kThickness, [&](std::size_t begin, std::size_t end) {
    Block block{Cell::Zero(), frame.size - Cell::Ones()};
    block.low[axis] = static_cast<std::int64_t>(begin);
    block.high[axis] = static_cast<std::int64_t>(end) - 1;
    painter.paint_slab(block);
  });
}

}  // namespace frontlux::sim
