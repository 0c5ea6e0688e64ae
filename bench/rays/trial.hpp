#pragma once

#include "rays/subject.hpp"
#include "rays/workload.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <iosfwd>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace frontlux::bench {

/// What is compared of an answer.
struct Answer {
  bool positive = false;  ///< visible, or castRay's return value
  Eigen::Vector3f end = Eigen::Vector3f::Zero();
  std::optional<Hit> hit;  ///< what a caster tells beside castRay's answer
};

/// Equal in every bit that both know.
[[nodiscard]] bool same(const Answer& a, const Answer& b);

/// One caster on one workload.
struct Entry : CasterCost {
  bool must_agree = true;
  std::function<void()> pass;                 ///< answers the whole workload once
  std::function<std::vector<Answer>()> read;  ///< the answers of the last pass of any entry
  double agreement = 0;                       ///< fraction of the rays with the answer of the reference
};

/// A foreign caster that takes part in the `visible` workloads. Its answers need not be exact.
struct Peer : CasterCost {
  std::function<void(std::span<const KeySegment>, std::span<std::uint8_t>)> visible;
};

/// One workload on one map: first checked, then timed, on the very same rays.
class Trial {
 public:
  /// @param subject  must outlive the trial
  Trial(const Subject& subject, Workload workload, std::span<const Peer> peers);
  ~Trial();

  /// Compares the answers of all entries with the reference: castRay for points, `exact_visibility` for keys.
  /// Prints the result in one line, and one more for every entry that should agree and does not.
  /// @return false if there is such an entry
  bool check(std::span<const int> threads, std::ostream& out);

  [[nodiscard]] const std::string& map() const { return subject_.name; }
  /// `<query>/<map>`
  [[nodiscard]] std::string name() const { return workload_.name + "/" + map(); }
  [[nodiscard]] const Workload& workload() const { return workload_; }
  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
  [[nodiscard]] double positive_fraction() const { return positive_fraction_; }
  [[nodiscard]] double mean_voxels() const { return mean_voxels_; }

  /// Facts about a row for the JSON.
  [[nodiscard]] std::map<std::string, double> counters(const Entry& entry) const;

 private:
  struct Buffers;
  void add_visible(std::span<const Peer> peers);
  void add_cast();
  void add_cast_single();
  [[nodiscard]] std::string describe_ray(std::size_t index) const;

  const Subject& subject_;
  Workload workload_;
  std::unique_ptr<Buffers> buffers_;
  std::vector<Entry> entries_;
  Entry reference_;  // its pass and what it read
  double positive_fraction_ = 0, mean_voxels_ = 0;
};

}  // namespace frontlux::bench
