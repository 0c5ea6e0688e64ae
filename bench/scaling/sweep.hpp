#pragma once

#include "options.hpp"
#include "rays/subject.hpp"
#include "rays/trial.hpp"

#include <iosfwd>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace frontlux::bench {

/// One place on one axis: a workload on a map.
struct Point {
  std::string axis;
  double x = 0;       ///< value on the axis; for `order` 0 in order, 1 shuffled
  std::string label;  ///< the value as text
  std::vector<int> threads;
  std::map<std::string, double> counters;  ///< facts for the JSON
  std::unique_ptr<Trial> trial;

  /// `<axis>/<query>/<map>/<value>`
  [[nodiscard]] std::string name() const;
};

/// The points of all axes of the options, and the maps that they refer to; maps that several axes use are
/// made once.
struct Sweep {
  std::vector<std::unique_ptr<Subject>> subjects;
  std::vector<Point> points;
  bool agreed =
      true;  ///< false if casters disagree where they must not; the other points are there all the same
};

/// Makes maps and rays and compares the answers of all casters on them.
[[nodiscard]] Sweep prepare_sweep(const ScalingOptions& options, std::ostream& out);

}  // namespace frontlux::bench
