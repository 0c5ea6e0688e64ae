#pragma once

#include "options.hpp"
#include "rays/subject.hpp"
#include "rays/trial.hpp"
#include "rays/workload.hpp"
#include "scaling/maps.hpp"

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
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

/// Prepares the points of all axes of the options. Maps that several axes use are made once.
class Sweep {
 public:
  /// @param options  must outlive this object
  Sweep(const ScalingOptions& options, std::ostream& out);

  /// Makes maps and rays and compares the answers of all casters on them.
  /// @return false if casters disagree where they must not; the other points are prepared all the same
  bool prepare();

  [[nodiscard]] const std::vector<Point>& points() const { return points_; }

 private:
  void vary_resolution();
  void vary_length();
  void vary_density();
  void vary_size();
  void vary_order();

  const Subject& building(double resolution);
  const Subject& blocks(double fraction);
  const Subject& rooms(const Rooms& rooms);
  const Subject& subject(const std::string& name, const std::function<Octree()>& make);

  void add(std::string axis, double x, std::string label, const Subject& subject, Workload workload);
  void add_lines(const std::string& axis, double x, const std::string& label, const Subject& subject,
                 double length, std::optional<std::size_t> rays);
  [[nodiscard]] Workload planned(const Subject& subject, std::string_view query) const;
  [[nodiscard]] std::size_t rays_for(const Workload& pilot, const Subject& subject) const;

  const ScalingOptions& options_;
  std::ostream& out_;
  std::vector<std::unique_ptr<Subject>> subjects_;
  std::map<const Subject*, std::map<std::string, double>> facts_;
  std::vector<Point> points_;
  std::string heading_;  // printed last
  bool agreed_ = true;
};

}  // namespace frontlux::bench
