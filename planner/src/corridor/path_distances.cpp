#include "corridor/path_distances.hpp"

#include <algorithm>
#include <bit>
#include <cstdlib>

namespace frontlux::planner::detail {

std::optional<std::array<int, 3>> CellFrame::place(const VoxelKey& key) const {
  const std::array<int, 3> offset = {key.x - first.x, key.y - first.y, key.z - first.z};
  if (stride == 1) {  // of most frames, and divisions take long
    for (std::size_t a = 0; a < 3; ++a)
      if (offset[a] < 0 || offset[a] >= size[a]) return std::nullopt;
    return offset;
  }
  std::array<int, 3> place{};
  for (std::size_t a = 0; a < 3; ++a) {
    if (offset[a] < 0 || offset[a] % stride != 0) return std::nullopt;
    place[a] = offset[a] / stride;
    if (place[a] >= size[a]) return std::nullopt;
  }
  return place;
}

CellFrame CellFrame::around(const VoxelKey& middle, int cells) const {
  CellFrame part = *this;
  const std::array<int, 3> at = {middle.x - first.x, middle.y - first.y, middle.z - first.z};
  std::array<int, 3> low{};
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = std::clamp(at[a] / stride - cells, 0, size[a]);
    part.size[a] = std::clamp(at[a] / stride + cells + 1, low[a], size[a]) - low[a];
  }
  part.first = key(low[0], low[1], low[2]);
  return part;
}

std::vector<CellMove> cell_moves(const CellFrame& frame, PathMetric metric) {
  std::vector<CellMove> moves;
  const int deepest = frame.size[2] > 1 ? 1 : 0;
  const auto axes = [](const std::array<int, 3>& step) {
    return static_cast<std::size_t>(std::abs(step[0]) + std::abs(step[1]) + std::abs(step[2]));
  };
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -deepest; z <= deepest; ++z) {
        const std::array<int, 3> step = {x, y, z};
        if (axes(step) == 0 || (metric == PathMetric::kSteps && axes(step) > 1)) continue;
        const auto offset = static_cast<std::ptrdiff_t>(frame.number(x, y, z) - frame.number(0, 0, 0));
        moves.push_back({offset, step, kMoveLengths[axes(step)], 0});
      }
  for (CellMove& move : moves)
    for (std::size_t i = 0; i < moves.size(); ++i) {
      const auto& part = moves[i].step;
      bool is_part = part != move.step;
      for (std::size_t a = 0; a < 3; ++a) is_part = is_part && (part[a] == 0 || part[a] == move.step[a]);
      if (is_part) move.corners |= std::uint32_t{1} << i;
    }
  return moves;
}

PathDistances::PathDistances(const CellFrame& frame, PathMetric metric)
    : frame_(frame), moves_(cell_moves(frame, metric)) {}

std::uint32_t PathDistances::closed_around(std::size_t cell) const {
  std::uint32_t closed = 0;
  for (std::size_t i = 0; i < moves_.size(); ++i)
    closed |=
        static_cast<std::uint32_t>(labels_[cell + static_cast<std::size_t>(moves_[i].offset)] == kClosed)
        << i;
  return closed;
}

void PathDistances::reset(const VoxelColumns& open) {
  labels_.resize(frame_.bordered_size(), kClosed);
  if (std::ranges::any_of(frame_.size, [](int size) { return size == 0; })) return;
  for (int x = 0; x < frame_.size[0]; ++x)
    for (int y = 0; y < frame_.size[1]; ++y) {
      const auto [column, lowest] = open.place_of(frame_.key(x, y, 0));
      const std::uint64_t* words = &open.bits[column];
      Label* labels = &labels_[frame_.number(x, y, 0)];
      for (unsigned z = 0; z < static_cast<unsigned>(frame_.size[2]); ++z) {
        const unsigned bit = lowest + z;
        labels[z] = (words[bit / 64] >> (bit % 64) & 1U) != 0 ? kUnreached : kClosed;
      }
    }
}

void PathDistances::close(const VoxelKey& key) {
  if (const auto at = frame_.place(key)) labels_[frame_.number((*at)[0], (*at)[1], (*at)[2])] = kClosed;
}

// Dijkstra's algorithm with buckets as wide as the shortest step: distances in the nearest bucket are final,
// whatever the order in which they are taken.
void PathDistances::spread(const VoxelKey& from) {
  struct Entry {
    std::uint32_t cell;
    Label label;
  };
  constexpr std::size_t kBuckets = 4;  // the longest step reaches two ahead
  constexpr Label kFarthest = kUnreached - 2 * kStraight;
  std::array<std::vector<Entry>, kBuckets> buckets;
  // As many moves as there can be, so that the loop below unrolls: the unused ones stay in place.
  std::array<std::ptrdiff_t, kMaxMoves> offsets{};
  std::array<Label, kMaxMoves> lengths{};
  for (std::size_t i = 0; i < moves_.size(); ++i) {
    offsets[i] = moves_[i].offset;
    lengths[i] = moves_[i].length;
  }
  const auto place = frame_.place(from);
  if (!place) return;
  const std::size_t start = frame_.number((*place)[0], (*place)[1], (*place)[2]);
  if (labels_[start] == kClosed) return;
  labels_[start] = kStart;
  buckets[0].push_back({static_cast<std::uint32_t>(start), kStart});
  std::size_t empty = 0;
  for (std::size_t now = 0; empty < kBuckets; ++now) {
    auto& bucket = buckets[now % kBuckets];
    empty = bucket.empty() ? empty + 1 : 0;
    for (const Entry& entry : bucket) {
      if (labels_[entry.cell] != entry.label || entry.label >= kFarthest) continue;
      // No branches here: few moves bring a neighbour nearer, and a processor cannot predict which.
      const Label* const cell_label = &labels_[entry.cell];
      std::uint32_t closed = 0, better = 0;
#pragma GCC unroll 26
      for (std::size_t i = 0; i < kMaxMoves; ++i) {
        const Label label = cell_label[offsets[i]];
        closed |= static_cast<std::uint32_t>(label == kClosed) << i;
        better |= static_cast<std::uint32_t>(entry.label + lengths[i] < label) << i;
      }
      for (; better != 0; better &= better - 1) {
        const CellMove& move = moves_[static_cast<std::size_t>(std::countr_zero(better))];
        if ((closed & move.corners) != 0) continue;
        const std::size_t cell = entry.cell + static_cast<std::size_t>(move.offset);
        const Label reached = entry.label + move.length;
        labels_[cell] = reached;
        buckets[(reached - kStart) / kStraight % kBuckets].push_back(
            {static_cast<std::uint32_t>(cell), reached});
      }
    }
    bucket.clear();
  }
}

PathDistances::Label PathDistances::label(const VoxelKey& key) const {
  const auto place = frame_.place(key);
  return place && !labels_.empty() ? labels_[frame_.number((*place)[0], (*place)[1], (*place)[2])] : kClosed;
}

bool PathDistances::open(const VoxelKey& key) const { return label(key) != kClosed; }

std::optional<double> PathDistances::distance(const VoxelKey& key) const {
  const Label found = label(key);
  if (found == kClosed || found == kUnreached) return std::nullopt;
  return static_cast<double>(found - kStart) / kStraight;
}

std::vector<VoxelKey> PathDistances::path_to(const VoxelKey& key) const {
  std::vector<VoxelKey> path;
  if (!distance(key)) return path;
  auto place = *frame_.place(key);
  std::size_t cell = frame_.number(place[0], place[1], place[2]);
  path.push_back(key);
  while (labels_[cell] != kStart) {
    const std::uint32_t closed = closed_around(cell);
    for (const CellMove& move : moves_) {
      const std::size_t before = cell + static_cast<std::size_t>(move.offset);
      if (labels_[before] == kClosed || labels_[before] == kUnreached || (closed & move.corners) != 0 ||
          labels_[before] + move.length != labels_[cell])
        continue;
      cell = before;
      for (std::size_t a = 0; a < 3; ++a) place[a] += move.step[a];
      break;
    }
    path.push_back(frame_.key(place[0], place[1], place[2]));
  }
  return {path.rbegin(), path.rend()};
}

void PathDistances::reached(std::vector<VoxelKey>& cells) const {
  for (int x = 0; x < frame_.size[0]; ++x)
    for (int y = 0; y < frame_.size[1]; ++y) {
      const Label* label = &labels_[frame_.number(x, y, 0)];
      for (int z = 0; z < frame_.size[2]; ++z)
        if (label[z] != kClosed && label[z] != kUnreached) cells.push_back(frame_.key(x, y, z));
    }
}

}  // namespace frontlux::planner::detail
