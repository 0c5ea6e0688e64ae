#include "mesh/triangle_overlap.hpp"
#include "truth/cell_paint.hpp"

#include <frontlux/sim/ground_truth.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace frontlux::sim {
namespace {

constexpr std::uint64_t kMostVoxels = std::uint64_t{1} << 31;

template <class... Parts>
[[noreturn]] void refuse(const Parts&... parts) {
  std::ostringstream text;
  text << "ground truth: ";
  (text << ... << parts);
  throw std::invalid_argument(text.str());
}

std::string text_of(const Eigen::Vector3d& point) {
  std::ostringstream text;
  text << point.x() << ", " << point.y() << ", " << point.z();
  return text.str();
}

Eigen::Vector3<std::int64_t> vector(const VoxelKey& key) { return {key.x, key.y, key.z}; }

double margin_at(double resolution) { return std::min(GroundTruth::kMargin, resolution / 4); }

bool equal(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b, double tolerance) {
  return (a.min() - b.min()).cwiseAbs().maxCoeff() <= tolerance &&
         (a.max() - b.max()).cwiseAbs().maxCoeff() <= tolerance;
}

CellFrame make_frame(const KeyBox& bounds, const Lattice& lattice) {
  const double edge = lattice.resolution();
  return {{lower_face(lattice, bounds.min.x), lower_face(lattice, bounds.min.y),
           lower_face(lattice, bounds.min.z)},
          edge,
          margin_at(edge),
          vector(bounds.max) - vector(bounds.min) + Eigen::Vector3<std::int64_t>::Ones()};
}

constexpr std::array kAxes = {&VoxelKey::x, &VoxelKey::y, &VoxelKey::z};

// If a world's bounds are where its mesh ends, the voxels within them and those behind outer faces on which
// it does: a wall on a face is mapped as the voxels behind it.
KeyBox with_voxels_behind(KeyBox box, const World& world, const Lattice& lattice) {
  const Eigen::AlignedBox3d mesh = bounds_of(world.mesh);
  const double margin = margin_at(lattice.resolution());
  if (mesh.isEmpty() || !equal(mesh, world.bounds, margin)) return box;
  const auto on_face = [&](double wall, int key) {
    return std::abs(wall - lower_face(lattice, key)) <= margin;
  };
  for (std::size_t i = 0; i < kAxes.size(); ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    std::uint16_t &low = box.min.*kAxes[i], &high = box.max.*kAxes[i];
    if (low > 0 && on_face(mesh.min()[axis], low)) --low;
    if (high + 1 < Lattice::kKeysPerAxis && on_face(mesh.max()[axis], high + 1)) ++high;
  }
  return box;
}

// The first triangle that passes through a voxel.
std::size_t triangle_in(const TriangleMesh& mesh, const Eigen::AlignedBox3d& inside) {
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    if (TriangleOverlap(corners_of(mesh, i)).touches(inside)) return i;
  throw std::logic_error("ground truth: a voxel without a surface counts as solid");
}

}  // namespace

KeyBox voxels_within(const Eigen::AlignedBox3d& bounds, const Lattice& lattice) {
  if (!bounds.min().allFinite() || !bounds.max().allFinite() || !(bounds.sizes().minCoeff() > 0.0))
    refuse("the bounds, from (", text_of(bounds.min()), ") to (", text_of(bounds.max()),
           ") m, have no volume or are not finite");
  constexpr double kSliver = 1e-6;
  std::array<int, 3> low{}, high{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const double first = std::floor(bounds.min()[axis] / lattice.resolution() + kSliver);
    const double last = std::max(first, std::ceil(bounds.max()[axis] / lattice.resolution() - kSliver) - 1);
    if (!(first >= -Lattice::kOrigin && last < Lattice::kKeysPerAxis - Lattice::kOrigin))
      refuse("the bounds reach from ", bounds.min()[axis], " to ", bounds.max()[axis], " m, but at ",
             lattice.resolution(), " m the map ends at +-", Lattice::kOrigin * lattice.resolution(),
             " m; use larger voxels, or scale or move the world");
    low[i] = static_cast<int>(first) + Lattice::kOrigin;
    high[i] = static_cast<int>(last) + Lattice::kOrigin;
  }
  return {make_key(low[0], low[1], low[2]), make_key(high[0], high[1], high[2])};
}

void GroundTruth::check_size() const {
  if (bounding_voxels() > kMostVoxels)
    refuse("the world has ", bounding_voxels(), " voxels of ", lattice_.resolution(),
           " m within its bounds, but 2^31 is the limit; use larger voxels or scale the world down");
}

GroundTruth::GroundTruth(const World& world, double resolution, const Eigen::Vector3d& start)
    : lattice_(resolution), bounds_(voxels_within(world.bounds, lattice_)) {
  check(world.mesh);
  check_size();
  const auto first = lattice_.key(start);
  if (!first || !bounds_.contains(*first))
    refuse("the start (", text_of(start), ") m lies outside of the world's bounds, (",
           text_of(world.bounds.min()), ") to (", text_of(world.bounds.max()), ") m");

  const KeyBox inside = std::exchange(bounds_, with_voxels_behind(bounds_, world, lattice_));
  check_size();
  const CellFrame frame = make_frame(bounds_, lattice_);
  cells_.resize(bounding_voxels());
  paint(world.mesh, frame, cells_);
  if (holds_surface(*first)) {
    const auto cell = (vector(*first) - vector(bounds_.min)).eval();
    refuse("the start (", text_of(start), ") m lies in a wall: triangle ",
           triangle_in(world.mesh, frame.box(cell, cell, -frame.margin)), " passes through its voxel of ",
           lattice_.resolution(), " m; start elsewhere, or use smaller voxels");
  }
  flood(index(*first), inside);
  drop_layers_that_show_nothing(inside);
}

// Those that were taken in behind the outside of solids.
void GroundTruth::drop_layers_that_show_nothing(const KeyBox& inside) {
  KeyBox box = bounds_;
  const auto shows_nothing = [this](const KeyBox& layer) {
    return all_of(layer, [this](const VoxelKey& key) { return !contains(key); });
  };
  for (const auto axis : kAxes) {
    KeyBox low = box, high = box;
    low.max.*axis = low.min.*axis;
    high.min.*axis = high.max.*axis;
    if (box.min.*axis < inside.min.*axis && shows_nothing(low)) ++(box.min.*axis);
    if (box.max.*axis > inside.max.*axis && shows_nothing(high)) --(box.max.*axis);
  }
  if (box == bounds_) return;
  std::vector<std::uint8_t> cells(size_of(box));
  for_each_key(box, [&](const VoxelKey& key) { cells[place_in(box, key)] = cells_[index(key)]; });
  cells_ = std::move(cells);
  bounds_ = box;
}

// @param inside  what may be free; of voxels beyond, only walls are seen
void GroundTruth::flood(std::size_t start, const KeyBox& inside) {
  const std::array<std::size_t, 3> size{bounds_.max.x - bounds_.min.x + std::size_t{1},
                                        bounds_.max.y - bounds_.min.y + std::size_t{1},
                                        bounds_.max.z - bounds_.min.z + std::size_t{1}};
  const std::array<std::size_t, 3> stride{1, size[0], size[0] * size[1]};
  const auto low = (vector(inside.min) - vector(bounds_.min)).cast<std::size_t>().eval(),
             high = (vector(inside.max) - vector(bounds_.min)).cast<std::size_t>().eval();
  // Two fronts instead of one stack: a front is as large as a surface, a stack may hold the whole volume.
  std::vector<std::uint32_t> front{static_cast<std::uint32_t>(start)}, next;
  cells_[start] |= cell::kReached;
  while (!front.empty()) {
    next.clear();
    for (const std::uint32_t here : front) {
      ++free_voxels_;
      const auto enter = [&](std::size_t neighbour, std::uint8_t walls, bool is_inside) {
        std::uint8_t& flags = cells_[neighbour];
        if ((flags & cell::kReached) != 0) return;
        if (walls != 0 || (flags & cell::kSolid) != 0) {
          flags |= cell::kNextToReached;
          return;
        }
        if (!is_inside) return;
        flags |= cell::kReached;
        next.push_back(static_cast<std::uint32_t>(neighbour));
      };
      const std::array<std::size_t, 3> at{here % size[0], here / stride[1] % size[1], here / stride[2]};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const unsigned wall = unsigned{cell::kWallBelow} << axis;
        const auto a = static_cast<Eigen::Index>(axis);
        if (at[axis] > 0)
          enter(here - stride[axis], static_cast<std::uint8_t>(cells_[here] & wall), at[axis] > low[a]);
        if (at[axis] + 1 < size[axis])
          enter(here + stride[axis], static_cast<std::uint8_t>(cells_[here + stride[axis]] & wall),
                at[axis] < high[a]);
      }
    }
    std::swap(front, next);
  }
  surface_voxels_ = static_cast<std::uint64_t>(std::ranges::count_if(cells_, [](std::uint8_t flags) {
    return (flags & (cell::kReached | cell::kNextToReached)) == cell::kNextToReached;
  }));
}

Truth GroundTruth::at(const VoxelKey& key) const {
  if (!bounds_.contains(key)) return Truth::kHidden;
  const std::uint8_t flags = cells_[index(key)];
  if ((flags & cell::kReached) != 0) return Truth::kFree;
  return (flags & cell::kNextToReached) != 0 ? Truth::kSurface : Truth::kHidden;
}

bool GroundTruth::holds_surface(const VoxelKey& key) const {
  return bounds_.contains(key) && (cells_[index(key)] & cell::kSolid) != 0;
}

bool GroundTruth::open(const VoxelKey& key, std::size_t axis) const {
  const auto next = offset_key(key, axis == 0, axis == 1, axis == 2);
  if (axis > 2 || !next || !bounds_.contains(key) || !bounds_.contains(*next)) return false;
  const std::uint8_t above = cells_[index(*next)];
  const unsigned wall = unsigned{cell::kWallBelow} << axis;
  return (cells_[index(key)] & above & cell::kReached) != 0 && (above & wall) == 0;
}

}  // namespace frontlux::sim
