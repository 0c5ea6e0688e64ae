#include "view/exact/ray_trie.hpp"

#include "view/azimuth_bins.hpp"
#include "walk/walk.hpp"

#include <frontlux/parallel.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace frontlux::detail {
namespace {

constexpr std::size_t kMaxSteps = std::size_t{1} << 27U;   // of all rays, before any are shared
constexpr std::size_t kMaxWindow = std::size_t{1} << 28U;  // [bytes]
constexpr std::size_t kGroupTargets = 24;                  // at most, in a group
constexpr std::uint32_t kForkNodes = 4;                    // at least, behind a node with `is_fork`

using Cell = std::array<int, 3>;

// A ray to an offset, and the voxel that it has come to.
class Line {
 public:
  explicit Line(const Cell& offset)
      : crossings_(crossings_of(kCenter, *offset_key(kCenter, offset[0], offset[1], offset[2]))),
        steps_left_(std::abs(offset[0]) + std::abs(offset[1]) + std::abs(offset[2])),
        offset_(offset) {
    look_ahead();
  }
  [[nodiscard]] const Cell& offset() const { return offset_; }
  [[nodiscard]] int steps_left() const { return steps_left_; }
  /// One of six, of the next step.
  [[nodiscard]] std::uint32_t direction() const { return direction_; }
  /// From the voxel where it is.
  [[nodiscard]] Cell next(Cell at) const {
    at[direction_ / 2] += crossings_.step[direction_ / 2];
    return at;
  }
  void advance() {
    crossings_.t_max[direction_ / 2] += crossings_.t_delta[direction_ / 2];
    --steps_left_;
    look_ahead();
  }

 private:
  static constexpr VoxelKey kCenter = make_key(Lattice::kOrigin, Lattice::kOrigin, Lattice::kOrigin);
  // Ties go to z before y before x (rule 5).
  void look_ahead() {
    const auto& t = crossings_.t_max;
    const std::uint32_t across = t[0] < t[1] ? 0 : 1;
    const std::uint32_t axis = t[across] < t[2] ? across : 2;
    direction_ = 2 * axis + (crossings_.step[axis] > 0 ? 1 : 0);
  }

  Crossings<std::int64_t> crossings_;
  int steps_left_;
  std::uint32_t direction_ = 0;
  Cell offset_;
};

template <class Visit>
void for_each_column(const ViewRegion& view, const Visit& visit) {
  for (int dx = -view.reach(); dx <= view.reach(); ++dx)
    for (int dy = -view.reach(); dy <= view.reach(); ++dy)
      if (const int height = view.height(dx, dy); height >= 0) visit(dx, dy, height);
}

}  // namespace

// Makes the trie of one sector.
class RayTrieBuilder {
 public:
  RayTrieBuilder(RayTrie& trie, std::vector<Line>& lines) : trie_(trie), lines_(lines) {}

  void build(int bin) {
    trie_.groups_.resize(1);  // of the targets that belong to no other
    std::vector<std::uint32_t> all(lines_.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint32_t>(i);
    // Targets next to the viewpoint are seen in any map.
    const auto far =
        std::partition(all.begin(), all.end(), [&](std::uint32_t l) { return lines_[l].steps_left() == 1; });
    for (auto l = all.begin(); l != far; ++l) loose_.push_back(place(lines_[*l].offset()));
    const auto adjacent = static_cast<std::uint32_t>(loose_.size());
    fork({far, all.end()}, {}, {}, 0);

    trie_.groups_[0].begin = count(trie_.targets_);
    trie_.targets_.insert(trie_.targets_.end(), loose_.begin(), loose_.end());
    trie_.groups_[0].end = count(trie_.targets_);
    trie_.sectors_.push_back({bin, 0, count(trie_.nodes_), 0, count(trie_.groups_), adjacent});
  }

 private:
  using Piece = std::vector<std::int32_t>;  // places that have to be free, since the last node
  using Lines = std::span<std::uint32_t>;

  template <class T>
  static std::uint32_t count(const std::vector<T>& list) {
    return static_cast<std::uint32_t>(list.size());
  }
  [[nodiscard]] std::int32_t place(const Cell& at) const { return trie_.layout_.offset(at[0], at[1], at[2]); }

  // Nodes for a piece, which is not empty. Returns the depth behind them.
  std::uint16_t add(const Piece& piece, std::optional<std::int32_t> target, std::uint16_t depth,
                    std::vector<std::uint32_t>& added) {
    for (std::size_t done = 0; done < piece.size(); done += RayTrie::Node::kSteps) {
      const bool last = done + RayTrie::Node::kSteps >= piece.size();
      RayTrie::Node node{};
      for (std::size_t s = 0; s < node.steps.size(); ++s)
        node.steps[s] = piece[std::min(done + s, piece.size() - 1)];
      node.target = last ? target.value_or(0) : 0;
      node.is_target = last && target ? 1 : 0;
      node.group = std::exchange(pending_group_, 0);
      node.depth = depth++;
      added.push_back(count(trie_.nodes_));
      trie_.nodes_.push_back(node);
      trie_.depth_ = std::max<std::size_t>(trie_.depth_, depth);
    }
    return depth;
  }
  void add_target(std::int32_t target) {
    if (group_ == 0) {
      loose_.push_back(target);
      return;
    }
    trie_.targets_.push_back(target);
    trie_.groups_[group_ - 1].end = count(trie_.targets_);
  }

  // Lines that part at a voxel, perhaps.
  void fork(Lines lines, const Cell& at, const Piece& piece, std::uint16_t depth) {
    auto rest = lines.begin();
    for (std::uint32_t direction = 0; direction < 6 && rest != lines.end(); ++direction) {
      const auto begin = rest;
      rest = std::partition(rest, lines.end(),
                            [&](std::uint32_t l) { return lines_[l].direction() == direction; });
      if (rest != begin) add_branch({begin, rest}, at, piece, depth);
    }
  }

  // Lines that take the same step next.
  void add_branch(Lines lines, Cell at, Piece piece, std::uint16_t depth) {
    std::vector<std::uint32_t> nodes;
    const bool opens_group = group_ == 0 && lines.size() <= kGroupTargets;
    if (opens_group) {
      trie_.groups_.push_back({count(trie_.targets_), count(trie_.targets_)});
      group_ = pending_group_ = count(trie_.groups_);
    }
    while (!lines.empty()) {
      const Cell before = at;
      at = lines_[lines.front()].next(before);
      for (const std::uint32_t l : lines) lines_[l].advance();
      const auto ends = std::find_if(lines.begin(), lines.end(),
                                     [&](std::uint32_t l) { return lines_[l].steps_left() == 0; });
      if (ends != lines.end()) {
        if (piece.empty()) piece.push_back(place(before));  // a fork, which is known to be free
        depth = add(piece, place(at), depth, nodes);
        add_target(place(at));
        piece.clear();
        std::swap(*ends, lines.back());
        lines = lines.first(lines.size() - 1);
      }
      piece.push_back(place(at));
      const bool parts = std::any_of(lines.begin(), lines.end(), [&](std::uint32_t l) {
        return lines_[l].direction() != lines_[lines.front()].direction();
      });
      if (!parts) continue;
      depth = add(piece, std::nullopt, depth, nodes);
      fork(lines, at, {}, depth);
      break;
    }
    const std::uint32_t end = count(trie_.nodes_);
    for (const std::uint32_t n : nodes) {
      trie_.nodes_[n].end = end;
      trie_.nodes_[n].is_fork = end - n > kForkNodes ? 1 : 0;
    }
    if (opens_group) group_ = 0;
  }

  RayTrie& trie_;
  std::vector<Line>& lines_;
  std::vector<std::int32_t> loose_;
  std::uint32_t group_ = 0, pending_group_ = 0;  // as in nodes
};

void RayTrie::append(const RayTrie& sector) {
  const auto nodes = static_cast<std::uint32_t>(nodes_.size());
  const auto groups = static_cast<std::uint32_t>(groups_.size());
  const auto targets = static_cast<std::uint32_t>(targets_.size());
  for (Node node : sector.nodes_) {
    node.end += nodes;
    nodes_.push_back(node);
  }
  for (const Group& group : sector.groups_) groups_.push_back({group.begin + targets, group.end + targets});
  most_groups_ = std::max(most_groups_, sector.groups_.size());
  targets_.insert(targets_.end(), sector.targets_.begin(), sector.targets_.end());
  for (const Sector& s : sector.sectors_)
    sectors_.push_back({s.bin, s.nodes_begin + nodes, s.nodes_end + nodes, s.groups_begin + groups,
                        s.groups_end + groups, s.adjacent});
  depth_ = std::max(depth_, sector.depth_);
}

std::optional<RayTrie> RayTrie::make(const ViewRegion& view, int azimuth_bins, int stride_x, int stride_y) {
  WindowLayout layout;
  layout.stride_x = stride_x;
  layout.stride_y = stride_y;
  std::size_t steps = 0;
  for_each_column(view, [&](int dx, int dy, int height) {
    layout.reach_x = std::max(layout.reach_x, std::abs(dx));
    layout.reach_y = std::max(layout.reach_y, std::abs(dy));
    layout.reach_z = std::max(layout.reach_z, height);
    steps += static_cast<std::size_t>((2 * height + 1) * (std::abs(dx) + std::abs(dy) + height / 2));
  });
  const auto levels = static_cast<std::size_t>(2 * layout.reach_z + 1);
  if (steps > kMaxSteps || levels * layout.level_bytes() > kMaxWindow) return std::nullopt;

  std::vector<std::vector<Line>> lines(static_cast<std::size_t>(azimuth_bins));
  for_each_column(view, [&](int dx, int dy, int height) {
    auto& sector = lines[static_cast<std::size_t>(azimuth_bin(std::atan2(dy, dx), azimuth_bins))];
    for (int dz = -height; dz <= height; ++dz) sector.emplace_back(Cell{dx, dy, dz});
  });
  std::vector<RayTrie> sectors(lines.size());
  for_each_index(lines.size(), [&](std::size_t bin) {
    if (lines[bin].empty()) return;
    sectors[bin].layout_ = layout;
    RayTrieBuilder(sectors[bin], lines[bin]).build(static_cast<int>(bin));
  });
  RayTrie trie;
  trie.layout_ = layout;
  for (const RayTrie& sector : sectors) trie.append(sector);
  return trie;
}

}  // namespace frontlux::detail
