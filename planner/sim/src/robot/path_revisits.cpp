#include <frontlux/sim/path_revisits.hpp>

#include <algorithm>
#include <cmath>

namespace frontlux::sim {
namespace {

// Of a cell with edges of `kNear`. Cells two million apart share a key, which costs time only.
std::uint64_t key_of(const Eigen::Vector3d& cell) {
  constexpr int kBits = 21;
  std::uint64_t key = 0;
  for (const double along : cell)
    key = key << kBits | (static_cast<std::uint64_t>(static_cast<std::int64_t>(along)) & ((1U << kBits) - 1));
  return key;
}

Eigen::Vector3d cell_of(const Eigen::Vector3d& place) {
  return (place / PathRevisits::kNear).array().floor();
}

}  // namespace

void PathRevisits::go_to(const Eigen::Vector3d& place) {
  const Eigen::Vector3d from = at_, motion = place - from;
  const double length = motion.norm(), pieces = std::ceil(length / kPiece);
  for (double i = 1.0; i <= pieces; ++i) add(from + i / pieces * motion, length / pieces);
  at_ = place;
}

void PathRevisits::add(const Eigen::Vector3d& end, double length) {
  length_ += length;
  for (; !recent_.empty() && recent_.front().along <= length_ - kBefore; recent_.pop_front())
    old_[key_of(cell_of(recent_.front().place))].push_back(recent_.front().place);
  if (was_near(end)) revisited_ += length;
  recent_.push_back({end, length_});
}

bool PathRevisits::was_near(const Eigen::Vector3d& place) const {
  const Eigen::Vector3d middle = cell_of(place);
  for (int i = 0; i < 27; ++i) {
    const Eigen::Vector3d cell = middle + Eigen::Vector3d(i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1);
    const auto found = old_.find(key_of(cell));
    if (found != old_.end() && std::ranges::any_of(found->second, [&](const Eigen::Vector3d& earlier) {
          return (earlier - place).squaredNorm() <= kNear * kNear;
        }))
      return true;
  }
  return false;
}

}  // namespace frontlux::sim
