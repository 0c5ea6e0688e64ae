#include "corridor/path_search.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <queue>
#include <tuple>

namespace frontlux::planner::detail {
namespace {

using Place = std::array<int, 3>;

// 0 for a cell that was not looked at, else closed, open, or 1 plus the length of the path so far.
using Label = std::uint32_t;
constexpr Label kUntested = 0, kStart = 1, kClosed = ~Label{0}, kUnreached = kClosed - 1;

// Of all cells with a border. Pages of it that no search comes to are never made.
class Labels {
 public:
  explicit Labels(std::size_t size) : labels_(static_cast<Label*>(std::calloc(size, sizeof(Label)))) {
    if (!labels_) throw std::bad_alloc();
  }
  [[nodiscard]] Label& operator[](std::size_t cell) const { return labels_.get()[cell]; }

 private:
  struct Free {
    void operator()(Label* labels) const { std::free(labels); }
  };
  std::unique_ptr<Label, Free> labels_;
};

// A cell to go on from: least length in all first, of these the longest path so far, then the lowest cell.
struct Entry {
  Label total, label;
  Place place;
  bool operator<(const Entry& other) const {
    return std::tie(other.total, label, other.place) < std::tie(total, other.label, place);
  }
};

Place moved(const Place& place, const CellMove& move) {
  return {place[0] + move.step[0], place[1] + move.step[1], place[2] + move.step[2]};
}

// The length of the path to the goal if all cells were open.
Label at_least(const Place& from, const Place& to, PathMetric metric) {
  std::array<Label, 3> away{};
  for (std::size_t a = 0; a < 3; ++a) away[a] = static_cast<Label>(std::abs(to[a] - from[a]));
  if (metric == PathMetric::kSteps) return kMoveLengths[1] * (away[0] + away[1] + away[2]);
  std::ranges::sort(away);
  return kMoveLengths[3] * away[0] + kMoveLengths[2] * (away[1] - away[0]) +
         kMoveLengths[1] * (away[2] - away[1]);
}

class Search {
 public:
  Search(const CellFrame& frame, PathMetric metric, const Place& goal,
         const std::function<bool(const VoxelKey&)>& open)
      : frame_(frame),
        metric_(metric),
        goal_(goal),
        open_(open),
        moves_(cell_moves(frame, metric)),
        labels_(frame.bordered_size()) {}

  /// Whether the goal was reached.
  [[nodiscard]] bool spread(const Place& start) {
    reach(start, kStart);
    while (!queue_.empty()) {
      const Entry entry = queue_.top();
      queue_.pop();
      if (entry.place == goal_) return true;
      const std::size_t cell = number(entry.place);
      if (labels_[cell] != entry.label) continue;
      test_around(cell, entry.place);
      for_each_move(cell, [&](const CellMove& move, Label& label) {
        if (entry.label + move.length < label) reach(moved(entry.place, move), entry.label + move.length);
        return true;
      });
    }
    return false;
  }

  /// From the goal back to the start. @pre it was reached
  [[nodiscard]] std::vector<VoxelKey> path_back() const {
    std::vector<VoxelKey> path{key(goal_)};
    Place place = goal_;
    while (labels_[number(place)] != kStart) {
      const std::size_t cell = number(place);
      for_each_move(cell, [&](const CellMove& move, const Label& label) {
        if (label == kUnreached || label + move.length != labels_[cell]) return true;
        place = moved(place, move);
        return false;
      });
      path.push_back(key(place));
    }
    return path;
  }

 private:
  [[nodiscard]] std::size_t number(const Place& place) const {
    return frame_.number(place[0], place[1], place[2]);
  }
  [[nodiscard]] VoxelKey key(const Place& place) const { return frame_.key(place[0], place[1], place[2]); }
  [[nodiscard]] bool is_inside(const Place& place) const {
    for (std::size_t a = 0; a < 3; ++a)
      if (place[a] < 0 || place[a] >= frame_.size[a]) return false;
    return true;
  }

  void reach(const Place& place, Label label) {
    labels_[number(place)] = label;
    queue_.push({label + at_least(place, goal_, metric_), label, place});
  }

  void test_around(std::size_t cell, const Place& place) {
    for (const CellMove& move : moves_) {
      Label& label = labels_[cell + static_cast<std::size_t>(move.offset)];
      if (label != kUntested) continue;
      const Place next = moved(place, move);
      label = is_inside(next) && open_(key(next)) ? kUnreached : kClosed;
    }
  }

  // Calls `visit(move, label)` for the moves that are possible, until it returns false.
  template <class Visit>
  void for_each_move(std::size_t cell, const Visit& visit) const {
    const auto label = [&](std::size_t i) -> Label& {
      return labels_[cell + static_cast<std::size_t>(moves_[i].offset)];
    };
    std::uint32_t closed = 0;
    for (std::size_t i = 0; i < moves_.size(); ++i)
      closed |= static_cast<std::uint32_t>(label(i) == kClosed || label(i) == kUntested) << i;
    for (std::size_t i = 0; i < moves_.size(); ++i)
      if (((closed >> i) & 1U) == 0 && (closed & moves_[i].corners) == 0 && !visit(moves_[i], label(i)))
        return;
  }

  const CellFrame& frame_;
  PathMetric metric_;
  Place goal_;
  const std::function<bool(const VoxelKey&)>& open_;
  std::vector<CellMove> moves_;
  Labels labels_;
  std::priority_queue<Entry> queue_;
};

}  // namespace

std::vector<VoxelKey> shortest_path(const CellFrame& frame, PathMetric metric, const VoxelKey& from,
                                    const VoxelKey& to, const std::function<bool(const VoxelKey&)>& open) {
  const auto start = frame.place(from), goal = frame.place(to);
  if (!start || !goal || !open(from) || !open(to)) return {};
  Search search(frame, metric, *goal, open);
  if (!search.spread(*start)) return {};
  std::vector<VoxelKey> path = search.path_back();
  std::ranges::reverse(path);
  return path;
}

}  // namespace frontlux::planner::detail
