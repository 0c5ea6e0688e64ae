#include <frontlux/planner/information_gain.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace frontlux::planner {
namespace {

constexpr Eigen::Index kBlock = 256;  // pairs evaluated together: some ten arrays of them stay in the cache

using Block = Eigen::Array<double, Eigen::Dynamic, 1, Eigen::ColMajor, kBlock, 1>;

void refuse(const std::string& what) { throw std::invalid_argument("information gain: " + what); }

void check_size(const char* what, std::size_t size, std::size_t wanted) {
  if (size != wanted)
    refuse(std::to_string(size) + " " + what + ", but " + std::to_string(wanted) + " wanted");
}

// A boundary of the view, with s >= 0 inside: 1 + exp(-k s), of which the membership is the inverse, and
// 1 - the logistic of k s.
struct Boundary {
  Block inverse, rest;
  Boundary(const Block& s, double sharpness) {
    rest = (-sharpness * s).exp();  // |s| <= 1 and the limit on sharpness: no product of these overflows
    inverse = 1.0 + rest;
    rest /= inverse;
  }
};

// The memberships of some pairs of one viewpoint, by direction alone, and their slopes by yaw.
struct FuzzyView {
  const FieldOfView& view;
  double sharpness;
  double cos_yaw, sin_yaw;

  template <class Part>
  void evaluate(const Part& ux, const Part& uy, const Part& uz, Block& membership, Block* slope) const {
    const Block forward = ux * cos_yaw + uy * sin_yaw, left = uy * cos_yaw - ux * sin_yaw;
    switch (view.shape) {
      case FieldOfView::Shape::kSpinning: {
        const double a = std::sin(view.vertical / 2), b = std::cos(view.vertical / 2);
        const Block flat = (ux.square() + uy.square()).sqrt();
        const Boundary top(a * flat - b * uz, sharpness), bottom(a * flat + b * uz, sharpness);
        membership = (top.inverse * bottom.inverse).inverse();
        if (slope != nullptr) *slope = Block::Zero(membership.size());
        return;
      }
      case FieldOfView::Shape::kPyramid: {
        const double ah = std::sin(view.horizontal / 2), bh = std::cos(view.horizontal / 2);
        const double av = std::sin(view.vertical / 2), bv = std::cos(view.vertical / 2);
        const Boundary l(ah * forward - bh * left, sharpness), r(ah * forward + bh * left, sharpness);
        const Boundary top(av * forward - bv * uz, sharpness), bottom(av * forward + bv * uz, sharpness);
        membership = (l.inverse * r.inverse * (top.inverse * bottom.inverse)).inverse();
        if (slope != nullptr)
          *slope = sharpness * membership *
                   (left * (ah * (l.rest + r.rest) + av * (top.rest + bottom.rest)) +
                    forward * (bh * (l.rest - r.rest)));
        return;
      }
      case FieldOfView::Shape::kCone: {
        // Up to 2 outside: still far from overflow.
        const Boundary rim(forward - std::cos(view.horizontal / 2), sharpness);
        membership = rim.inverse.inverse();
        if (slope != nullptr) *slope = sharpness * membership * rim.rest * left;
        return;
      }
    }
  }
};

}  // namespace

void GainOptions::check() const {
  if (!(detection > 0.0 && detection < 1.0))
    refuse("detection is " + std::to_string(detection) + ", but has to lie between 0 and 1");
  if (!(range_sharpness > 0.0 && std::isfinite(range_sharpness)))
    refuse("range_sharpness is " + std::to_string(range_sharpness) + " / m, but has to be positive");
}

void check_sharpness(double sharpness) {
  if (!(sharpness > 0.0 && sharpness <= InformationGain::kMaxSharpness))
    refuse("sharpness is " + std::to_string(sharpness) + ", but has to be above 0 and at most " +
           std::to_string(InformationGain::kMaxSharpness));
}

InformationGain::InformationGain(std::span<const Pose> viewpoints, std::span<const Eigen::Vector3d> frontiers,
                                 const VisiblePairs& pairs, const FieldOfView& view,
                                 const GainOptions& options)
    : frontiers_(frontiers.begin(), frontiers.end()), view_(view), options_(options) {
  check_finite(viewpoints);
  view.check();
  options.check();
  check_size("viewpoints", viewpoints.size(), pairs.viewpoints());
  check_size("frontiers", frontiers.size(), pairs.frontiers());
  for (std::size_t j = 0; j < frontiers.size(); ++j)
    if (!frontiers[j].allFinite()) refuse("frontier " + std::to_string(j) + " is not finite");

  const auto count = static_cast<Eigen::Index>(pairs.size());
  for (Eigen::ArrayXd* part : {&x_, &y_, &z_, &ux_, &uy_, &uz_, &fade_}) part->resize(count);
  seen_.reserve(pairs.size());
  within_.reserve(pairs.size());
  first_.assign(1, 0);
  for (std::size_t i = 0; i < viewpoints.size(); ++i) {
    positions_.push_back(viewpoints[i].position);
    for (const std::uint32_t j : pairs.frontiers_of(i)) {
      const Eigen::Vector3d offset = frontiers_[j] - positions_[i];
      const double range = offset.norm();
      const bool apart = range > 0.0 && std::isfinite(range);
      const Eigen::Vector3d u = apart ? Eigen::Vector3d(offset / range) : Eigen::Vector3d::Zero();
      const auto p = static_cast<Eigen::Index>(seen_.size());
      x_[p] = offset.x(), y_[p] = offset.y(), z_[p] = offset.z();
      ux_[p] = u.x(), uy_[p] = u.y(), uz_[p] = u.z();
      fade_[p] = apart ? 1.0 / (1.0 + std::exp(-options.range_sharpness * (view.max_range - range))) : 0.0;
      seen_.push_back(j);
      // The same comparisons as in FieldOfView, for `in_view` to be exact.
      const double squared = offset.squaredNorm();
      within_.push_back(view.sees_all_around() ? view.contains_at_some_yaw(offset)
                                               : squared > 0.0 && squared <= view.max_range * view.max_range);
    }
    first_.push_back(seen_.size());
  }
}

InformationGain::~InformationGain() = default;
InformationGain::InformationGain(const InformationGain&) = default;
InformationGain& InformationGain::operator=(const InformationGain&) = default;
InformationGain::InformationGain(InformationGain&&) noexcept = default;
InformationGain& InformationGain::operator=(InformationGain&&) noexcept = default;

void InformationGain::check_yaws(std::span<const double> yaws) const {
  check_size("yaws", yaws.size(), viewpoints());
  for (std::size_t i = 0; i < yaws.size(); ++i)
    if (!std::isfinite(yaws[i])) refuse("yaw " + std::to_string(i) + " is " + std::to_string(yaws[i]));
}

// One number for each pair, in the order of the viewpoints.
struct InformationGain::Memberships {
  Eigen::ArrayXd value;
  Eigen::ArrayXd slope;  // by the yaw of the pair's viewpoint [1/rad]; empty if not wanted
};

InformationGain::Memberships InformationGain::memberships(std::span<const double> yaws, double sharpness,
                                                          bool slopes) const {
  Memberships m;
  m.value.resize(x_.size());
  if (slopes) m.slope.resize(x_.size());
  Block value, slope;
  for (std::size_t i = 0; i < viewpoints(); ++i) {
    const FuzzyView fuzzy{view_, sharpness, std::cos(yaws[i]), std::sin(yaws[i])};
    const auto end = static_cast<Eigen::Index>(first_[i + 1]);
    for (auto p = static_cast<Eigen::Index>(first_[i]); p < end; p += kBlock) {
      const Eigen::Index n = std::min(kBlock, end - p);
      fuzzy.evaluate(ux_.segment(p, n), uy_.segment(p, n), uz_.segment(p, n), value,
                     slopes ? &slope : nullptr);
      m.value.segment(p, n) = value * fade_.segment(p, n);
      if (slopes) m.slope.segment(p, n) = slope * fade_.segment(p, n);
    }
  }
  return m;
}

double InformationGain::value(std::span<const double> yaws, double sharpness,
                              std::span<double> gradient) const {
  check_yaws(yaws);
  check_sharpness(sharpness);
  if (!gradient.empty()) check_size("derivatives", gradient.size(), viewpoints());
  const Memberships m = memberships(yaws, sharpness, !gradient.empty());
  if (options_.mode == GainMode::kSum) {
    for (std::size_t i = 0; i < gradient.size(); ++i)
      gradient[i] = m.slope
                        .segment(static_cast<Eigen::Index>(first_[i]),
                                 static_cast<Eigen::Index>(first_[i + 1] - first_[i]))
                        .sum();
    return m.value.sum();
  }
  // The probability that a frontier is missed by all. A factor is at least 1 - detection, never near 0, so
  // that the factor of one viewpoint can be divided out again.
  std::vector<double> missed(frontiers_.size(), 1.0);
  for (std::size_t p = 0; p < seen_.size(); ++p)
    missed[seen_[p]] *= 1.0 - options_.detection * m.value[static_cast<Eigen::Index>(p)];
  double gain = 0.0;
  for (const double all : missed) gain += 1.0 - all;
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    double sum = 0.0;
    for (std::size_t p = first_[i]; p < first_[i + 1]; ++p) {
      const auto q = static_cast<Eigen::Index>(p);
      sum += m.slope[q] * missed[seen_[p]] / (1.0 - options_.detection * m.value[q]);
    }
    gradient[i] = options_.detection * sum;
  }
  return gain;
}

std::span<const std::uint32_t> InformationGain::frontiers_of(std::size_t viewpoint) const {
  return std::span(seen_).subspan(first_.at(viewpoint), first_.at(viewpoint + 1) - first_.at(viewpoint));
}

void InformationGain::in_view(std::size_t viewpoint, double yaw, std::span<std::uint8_t> in_view) const {
  if (viewpoint >= viewpoints())
    refuse("there is no viewpoint " + std::to_string(viewpoint) + " of " + std::to_string(viewpoints()));
  if (!std::isfinite(yaw)) refuse("yaw is " + std::to_string(yaw));
  const std::size_t first = first_[viewpoint], count = first_[viewpoint + 1] - first;
  check_size("answers", in_view.size(), count);
  const double c = std::cos(yaw), s = std::sin(yaw);
  const double *x = x_.data() + first, *y = y_.data() + first, *z = z_.data() + first;
  const std::uint8_t* within = within_.data() + first;
  switch (view_.shape) {
    case FieldOfView::Shape::kSpinning:
      std::copy_n(within, count, in_view.begin());
      break;
    case FieldOfView::Shape::kPyramid: {
      const double wide = std::tan(view_.horizontal / 2), high = std::tan(view_.vertical / 2);
      for (std::size_t p = 0; p < count; ++p) {
        const double forward = x[p] * c + y[p] * s, left = y[p] * c - x[p] * s;
        const int inside = static_cast<int>(std::fabs(left) <= wide * forward) &
                           static_cast<int>(std::fabs(z[p]) <= high * forward);
        in_view[p] = static_cast<std::uint8_t>(within[p] & inside);
      }
      break;
    }
    case FieldOfView::Shape::kCone: {
      const double rim = std::cos(view_.horizontal / 2);
      for (std::size_t p = 0; p < count; ++p) {
        const double squared = Eigen::Vector3d(x[p], y[p], z[p]).squaredNorm();
        in_view[p] = static_cast<std::uint8_t>(
            within[p] & static_cast<int>(x[p] * c + y[p] * s >= rim * std::sqrt(squared)));
      }
      break;
    }
  }
}

std::uint64_t InformationGain::distinct(std::span<const double> yaws) const {
  check_yaws(yaws);
  std::vector<std::uint8_t> seen(frontiers_.size(), 0), answers;
  for (std::size_t i = 0; i < viewpoints(); ++i) {
    const auto mine = frontiers_of(i);
    answers.resize(mine.size());
    in_view(i, yaws[i], answers);
    for (std::size_t p = 0; p < mine.size(); ++p) seen[mine[p]] |= answers[p];
  }
  std::uint64_t count = 0;
  for (const std::uint8_t one : seen) count += one;
  return count;
}

}  // namespace frontlux::planner
