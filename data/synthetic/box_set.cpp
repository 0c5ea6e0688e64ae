#include <frontlux/synthetic/box_set.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

namespace frontlux::synthetic {
namespace {

constexpr double kMiss = std::numeric_limits<double>::infinity();
constexpr std::uint32_t kLeafBoxes = 4;

struct Line {
  std::array<double, 3> origin, inverse;
  std::array<bool, 3> parallel;
};

Line make_line(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  Line line{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    line.origin[i] = origin[axis];
    line.inverse[i] = 1.0 / direction[axis];
    line.parallel[i] = !std::isfinite(line.inverse[i]);
  }
  return line;
}

// Distance at which the line enters the box. Each step rounds monotonically in the box's faces, so that a box
// around another is never entered later than that one: this makes the hierarchy exact, without a tolerance.
double enter(const Line& line, const Box& box) {
  double near = 0.0, far = kMiss;
  for (std::size_t i = 0; i < 3; ++i) {
    const double low = box.min().data()[i] - line.origin[i], high = box.max().data()[i] - line.origin[i];
    if (line.parallel[i]) {
      if (low > 0.0 || high < 0.0) return kMiss;
      continue;
    }
    const double a = low * line.inverse[i], b = high * line.inverse[i];
    near = std::max(near, std::min(a, b));
    far = std::min(far, std::max(a, b));
  }
  return near <= far ? near : kMiss;
}

}  // namespace

BoxSet::BoxSet(std::vector<Box> boxes) : boxes_(std::move(boxes)), order_(boxes_.size()) {
  for (std::size_t i = 0; i < boxes_.size(); ++i)
    if (boxes_[i].isEmpty() || !boxes_[i].min().allFinite() || !boxes_[i].max().allFinite())
      throw std::invalid_argument("BoxSet: box " + std::to_string(i) + " is empty or not finite");
  std::iota(order_.begin(), order_.end(), 0U);
  if (!boxes_.empty()) build(0, static_cast<std::uint32_t>(boxes_.size()));
}

void BoxSet::build(std::uint32_t first, std::uint32_t count) {
  const std::size_t node = nodes_.size();
  nodes_.emplace_back();
  Box bounds, centers;
  for (std::uint32_t i = first; i < first + count; ++i) {
    bounds.extend(boxes_[order_[i]]);
    centers.extend(boxes_[order_[i]].center());
  }
  nodes_[node].bounds = bounds;
  if (count <= kLeafBoxes) {
    nodes_[node].first = first;
    nodes_[node].count = count;
    return;
  }
  Eigen::Index axis = 0;
  centers.sizes().maxCoeff(&axis);
  const auto begin = order_.begin() + static_cast<std::ptrdiff_t>(first);
  const std::uint32_t half = count / 2;
  std::nth_element(begin, begin + half, begin + count, [&](std::uint32_t a, std::uint32_t b) {
    return boxes_[a].center()[axis] < boxes_[b].center()[axis];
  });
  build(first, half);
  nodes_[node].first = static_cast<std::uint32_t>(nodes_.size());
  build(first + half, count - half);
}

std::optional<BoxSet::Hit> BoxSet::first_hit(const Eigen::Vector3d& origin,
                                             const Eigen::Vector3d& direction) const {
  if (nodes_.empty()) return std::nullopt;
  const Line line = make_line(origin, direction);
  Hit best{kMiss, boxes_.size()};
  struct Entry {
    std::uint32_t node;
    double distance;
  };
  // Halving 2^32 boxes down to one leaf leaves at most one waiting node on each level.
  std::array<Entry, 40> stack;
  std::size_t size = 0;
  stack[size++] = {0, enter(line, nodes_[0].bounds)};
  while (size > 0) {
    const Entry entry = stack[--size];
    if (entry.distance == kMiss || entry.distance > best.distance) continue;
    const Node& node = nodes_[entry.node];
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const double distance = enter(line, boxes_[order_[i]]);
      if (distance == kMiss || distance > best.distance) continue;
      if (distance < best.distance || order_[i] < best.box) best = {distance, order_[i]};
    }
    if (node.count > 0) continue;
    Entry left{entry.node + 1, enter(line, nodes_[entry.node + 1].bounds)};
    Entry right{node.first, enter(line, nodes_[node.first].bounds)};
    if (right.distance < left.distance) std::swap(left, right);
    stack[size++] = right;
    stack[size++] = left;
  }
  if (best.distance == kMiss) return std::nullopt;
  return best;
}

bool BoxSet::overlaps(const Box& box) const {
  return std::any_of(boxes_.begin(), boxes_.end(), [&](const Box& other) { return other.intersects(box); });
}

}  // namespace frontlux::synthetic
