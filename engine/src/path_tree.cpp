#include "path_tree.hpp"

#include "walk.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace frontlux::detail {
namespace {

constexpr std::size_t kMaxSteps = std::size_t{1} << 27U;   // of all paths, before any are shared
constexpr std::size_t kMaxWindow = std::size_t{1} << 28U;  // [bytes]
constexpr std::size_t kGroupTargets = 24;                  // at most, in a group
constexpr std::uint32_t kForkNodes = 4;                    // at least, behind a node that is looked at

using Cell = std::array<int, 3>;

// A path on its way to an offset.
struct Line {
  Crossings<std::int64_t> crossings;
  Cell to;

  // Along which axis the next step goes. Ties go to z before y before x (rule 5).
  [[nodiscard]] std::size_t next_axis() const {
    const auto& t = crossings.t_max;
    const std::size_t across = t[0] < t[1] ? 0 : 1;
    return t[across] < t[2] ? across : 2;
  }
  // One of six.
  [[nodiscard]] std::size_t next_direction() const {
    const std::size_t axis = next_axis();
    return 2 * axis + (crossings.step[axis] > 0 ? 1 : 0);
  }
  void advance(Cell& at) {
    const std::size_t axis = next_axis();
    crossings.t_max[axis] += crossings.t_delta[axis];
    at[axis] += crossings.step[axis];
  }
};

Line line_to(const Cell& offset) {
  const auto key = [](int d) { return static_cast<std::uint16_t>(Lattice::kOrigin + d); };
  return {crossings_of({key(0), key(0), key(0)}, {key(offset[0]), key(offset[1]), key(offset[2])}), offset};
}

template <class Visit>
void for_each_offset(const ViewReach& reach, const Visit& visit) {
  const int radius = reach.table_radius();
  for (int dx = -radius; dx <= radius; ++dx)
    for (int dy = -radius; dy <= radius; ++dy) {
      const int height = reach.heights()[reach.entry(dx, dy)];
      if (height >= 0) visit(dx, dy, height);
    }
}

}  // namespace

class PathTreeBuilder {
 public:
  explicit PathTreeBuilder(PathTree& tree) : tree_(tree) {}

  // The tree of one sector.
  void build(std::vector<Line> lines, int bin) {
    lines_ = std::move(lines);
    sector_ = PathTree::Sector{};
    sector_.bin = bin;
    sector_.nodes_begin = next(tree_.nodes_);
    sector_.groups_begin = next(tree_.groups_);
    tree_.groups_.emplace_back();
    loose_.clear();
    group_ = 0;

    std::vector<std::uint32_t> all(lines_.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint32_t>(i);
    // What is next to the viewpoint is seen whatever is free.
    const auto far = std::partition(all.begin(), all.end(), [&](std::uint32_t l) {
      const Cell& to = lines_[l].to;
      return std::abs(to[0]) + std::abs(to[1]) + std::abs(to[2]) == 1;
    });
    sector_.adjacent = static_cast<std::uint32_t>(far - all.begin());
    for (auto l = all.begin(); l != far; ++l) loose_.push_back(place(lines_[*l].to));
    fork({far, all.end()}, {}, {}, 0);

    tree_.groups_[sector_.groups_begin].begin = next(tree_.targets_);
    tree_.targets_.insert(tree_.targets_.end(), loose_.begin(), loose_.end());
    tree_.groups_[sector_.groups_begin].end = next(tree_.targets_);
    sector_.nodes_end = next(tree_.nodes_);
    sector_.groups_end = next(tree_.groups_);
    tree_.sectors_.push_back(sector_);
  }

 private:
  using Piece = std::vector<std::int32_t>;  // places that have to be free, since the last node
  using Lines = std::span<std::uint32_t>;

  template <class T>
  static std::uint32_t next(const std::vector<T>& list) {
    return static_cast<std::uint32_t>(list.size());
  }
  [[nodiscard]] std::int32_t place(const Cell& at) const { return tree_.layout_.offset(at[0], at[1], at[2]); }

  // Nodes for a piece, which is not empty. Returns the depth behind them.
  std::uint16_t add(const Piece& piece, std::optional<std::int32_t> target, std::uint16_t depth,
                    std::vector<std::uint32_t>& added) {
    for (std::size_t done = 0; done < piece.size(); done += PathTree::Node::kSteps) {
      const bool last = done + PathTree::Node::kSteps >= piece.size();
      PathTree::Node node{};
      for (std::size_t s = 0; s < node.steps.size(); ++s)
        node.steps[s] = piece[std::min(done + s, piece.size() - 1)];
      node.target = last ? target.value_or(0) : 0;
      node.is_target = last && target ? 1 : 0;
      node.group = std::exchange(pending_group_, 0);
      node.depth = depth++;
      added.push_back(next(tree_.nodes_));
      tree_.nodes_.push_back(node);
      tree_.depth_ = std::max<std::size_t>(tree_.depth_, depth);
    }
    return depth;
  }
  void add_target(std::int32_t target) {
    if (group_ == 0) {
      loose_.push_back(target);
      return;
    }
    tree_.targets_.push_back(target);
    tree_.groups_[group_].end = next(tree_.targets_);
  }

  // Lines that part at a voxel, perhaps.
  void fork(Lines lines, const Cell& at, const Piece& piece, std::uint16_t depth) {
    const auto direction = [this](std::uint32_t l) { return lines_[l].next_direction(); };
    std::stable_sort(lines.begin(), lines.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return direction(a) < direction(b); });
    for (std::size_t begin = 0, end = 0; begin < lines.size(); begin = end) {
      for (end = begin; end < lines.size() && direction(lines[end]) == direction(lines[begin]);) ++end;
      follow(lines.subspan(begin, end - begin), at, piece, depth);
    }
  }

  // Lines that take the same step next.
  void follow(Lines lines, Cell at, Piece piece, std::uint16_t depth) {
    std::vector<std::uint32_t> nodes;
    const bool opens_group = group_ == 0 && lines.size() <= kGroupTargets;
    if (opens_group) {
      group_ = pending_group_ = next(tree_.groups_);
      tree_.groups_.push_back({next(tree_.targets_), next(tree_.targets_)});
    }
    while (!lines.empty()) {
      const Cell before = at;
      for (const std::uint32_t l : lines) {
        Cell moved = before;
        lines_[l].advance(moved);
        at = moved;
      }
      const auto ends =
          std::find_if(lines.begin(), lines.end(), [&](std::uint32_t l) { return lines_[l].to == at; });
      if (ends != lines.end()) {
        if (piece.empty()) piece.push_back(place(before));  // a fork, which is known to be free
        depth = add(piece, place(at), depth, nodes);
        add_target(place(at));
        piece.clear();
        std::swap(*ends, lines.back());
        lines = lines.first(lines.size() - 1);
      }
      piece.push_back(place(at));
      const bool parts = lines.size() > 1 && std::any_of(lines.begin(), lines.end(), [&](std::uint32_t l) {
                           return lines_[l].next_direction() != lines_[lines.front()].next_direction();
                         });
      if (!parts) continue;
      depth = add(piece, std::nullopt, depth, nodes);
      fork(lines, at, {}, depth);
      break;
    }
    const std::uint32_t end = next(tree_.nodes_);
    for (const std::uint32_t n : nodes) {
      tree_.nodes_[n].end = end;
      tree_.nodes_[n].is_fork = end - n > kForkNodes ? 1 : 0;
    }
    if (opens_group) group_ = 0;
  }

  PathTree& tree_;
  std::vector<Line> lines_;
  PathTree::Sector sector_;
  std::vector<std::int32_t> loose_;
  std::uint32_t group_ = 0, pending_group_ = 0;
};

std::optional<PathTree> PathTree::make(const ViewReach& reach, int azimuth_bins, int stride_x, int stride_y) {
  PathTree tree;
  WindowLayout& layout = tree.layout_;
  layout.stride_x = stride_x;
  layout.stride_y = stride_y;
  std::size_t steps = 0;
  for_each_offset(reach, [&](int dx, int dy, int height) {
    layout.reach_x = std::max(layout.reach_x, std::abs(dx));
    layout.reach_y = std::max(layout.reach_y, std::abs(dy));
    layout.reach_z = std::max(layout.reach_z, height);
    steps += static_cast<std::size_t>((2 * height + 1) * (std::abs(dx) + std::abs(dy) + height / 2));
  });
  const auto levels = static_cast<std::size_t>(2 * layout.reach_z + 1);
  if (steps > kMaxSteps || levels * layout.level_bytes() > kMaxWindow) return std::nullopt;

  std::vector<std::vector<Line>> sectors(static_cast<std::size_t>(azimuth_bins));
  for_each_offset(reach, [&](int dx, int dy, int height) {
    auto& lines = sectors[static_cast<std::size_t>(azimuth_bin(std::atan2(dy, dx), azimuth_bins))];
    for (int dz = -height; dz <= height; ++dz) lines.push_back(line_to({dx, dy, dz}));
  });
  tree.groups_.emplace_back();  // 0 is no group
  PathTreeBuilder builder(tree);
  for (std::size_t bin = 0; bin < sectors.size(); ++bin)
    if (!sectors[bin].empty()) builder.build(std::move(sectors[bin]), static_cast<int>(bin));
  return tree;
}

}  // namespace frontlux::detail
