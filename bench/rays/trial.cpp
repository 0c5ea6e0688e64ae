#include "rays/trial.hpp"

#include "rays/castray_loop.hpp"
#include "rays/exact_visibility.hpp"
#include "table.hpp"

#include <tbb/task_arena.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <ostream>

namespace frontlux::bench {
namespace {

bool same_bits(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return std::memcmp(a.data(), b.data(), 3 * sizeof(float)) == 0;
}

Answer answer_of(const Hit& hit) {
  const bool untouched = hit.stop == RayStop::kInvalid;
  return {hit.occupied(), untouched ? CastRayAnswers::kUntouched : hit.end, hit};
}

std::string describe(const Answer& a) {
  std::string text =
      format("%s, end %.9g %.9g %.9g", a.positive ? "true" : "false", static_cast<double>(a.end.x()),
             static_cast<double>(a.end.y()), static_cast<double>(a.end.z()));
  if (a.hit) {
    const Eigen::Vector3d entry = a.hit->entry.cast<double>();
    text += format(", stop %d, key %d %d %d, state %d, entry %.9g %.9g %.9g, distance %.9g",
                   static_cast<int>(a.hit->stop), a.hit->key.x, a.hit->key.y, a.hit->key.z,
                   static_cast<int>(a.hit->state), entry.x(), entry.y(), entry.z(),
                   static_cast<double>(a.hit->distance));
  }
  return text;
}

}  // namespace

bool same(const Answer& a, const Answer& b) {
  return a.positive == b.positive && same_bits(a.end, b.end) &&
         (!a.hit || !b.hit ||
          (a.hit->stop == b.hit->stop && a.hit->state == b.hit->state && a.hit->key == b.hit->key &&
           same_bits(a.hit->entry, b.hit->entry) &&
           std::bit_cast<std::uint32_t>(a.hit->distance) == std::bit_cast<std::uint32_t>(b.hit->distance)));
}

/// Where passes write. Shared by all entries, so that every caster writes to the same, already touched pages.
struct Trial::Buffers {
  std::vector<std::uint8_t> visible;
  std::vector<std::vector<Hit>> hits;
  std::vector<CastRayAnswers> castray;

  /// Writes values that no caster answers.
  void clear() {
    std::fill(visible.begin(), visible.end(), std::uint8_t{0xAA});
    const Eigen::Vector3f nowhere = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
    for (auto& batch : hits)
      std::fill(batch.begin(), batch.end(), Hit{RayStop::kLeftMap, {}, {}, nowhere, nowhere, 0});
    for (auto& batch : castray) std::fill(batch.end.begin(), batch.end.end(), nowhere);
  }

  [[nodiscard]] std::vector<Answer> read_visible() const {
    std::vector<Answer> answers;
    for (const std::uint8_t v : visible)
      answers.push_back({v != 0, {static_cast<float>(v), 0.0F, 0.0F}, std::nullopt});
    return answers;
  }
  [[nodiscard]] std::vector<Answer> read_hits() const {
    std::vector<Answer> answers;
    for (const auto& batch : hits)
      for (const Hit& hit : batch) answers.push_back(answer_of(hit));
    return answers;
  }
  [[nodiscard]] std::vector<Answer> read_castray() const {
    std::vector<Answer> answers;
    for (const CastRayAnswers& batch : castray) {
      for (std::size_t i = 0; i < batch.end.size(); ++i)
        answers.push_back({batch.occupied[i] != 0, batch.end[i], std::nullopt});
    }
    return answers;
  }
};

Trial::Trial(const Subject& subject, Workload workload, std::span<const Peer> peers)
    : subject_(subject), workload_(std::move(workload)), buffers_(std::make_unique<Buffers>()) {
  buffers_->visible.resize(workload_.segments.size());
  for (const RayBatch& batch : workload_.batches) {
    buffers_->hits.emplace_back(batch.rays.size());
    buffers_->castray.emplace_back(batch.rays.size());
  }
  if (!workload_.segments.empty()) {
    add_visible(peers);
  } else if (workload_.name == "cast_single") {
    add_cast_single();
  } else {
    add_cast();
  }
  mean_voxels_ = bench::mean_voxels(workload_, subject.caster(kGrid), subject.grid.lattice());
}

Trial::~Trial() = default;

std::map<std::string, double> Trial::counters(const Entry& entry) const {
  return {{"rays", static_cast<double>(workload_.size())},
          {"agreement", entry.agreement},
          {"hit_fraction", positive_fraction_},
          {"mean_voxels", mean_voxels_},
          {"build_seconds", entry.build_seconds},
          {"update_seconds", entry.update_seconds},
          {"look_voxels", subject_.look_voxels},
          {"memory_bytes", static_cast<double>(entry.bytes)}};
}

void Trial::add_visible(std::span<const Peer> peers) {
  const auto read = [this] { return buffers_->read_visible(); };
  for (const Contender& c : subject_.contenders) {
    const auto pass = [this, &rays = *c.rays] {
      rays.visible(workload_.segments, buffers_->visible, UnknownPolicy::kBlock);
    };
    // Between voxel centres castRay rounds, and may pass an edge or corner on either side.
    entries_.push_back({c, c.caster != kOctomap, pass, read});
  }
  const auto by_definition = [this] {
    exact_visibility(subject_.grid, workload_.segments, buffers_->visible, UnknownPolicy::kBlock);
  };
  reference_ = {{}, true, by_definition, read};
  for (const Peer& peer : peers) {
    const auto pass = [this, visible = peer.visible] { visible(workload_.segments, buffers_->visible); };
    entries_.push_back({peer, false, pass, read});
  }
}

void Trial::add_cast() {
  const auto cast = [this](auto each) {
    return [this, each] {
      for (std::size_t b = 0; b < workload_.batches.size(); ++b) each(workload_.batches[b], b);
    };
  };
  for (const Contender& c : subject_.contenders) {
    const auto pass = cast([this, &rays = *c.rays](const RayBatch& batch, std::size_t b) {
      rays.cast(batch.rays, buffers_->hits[b], batch.unknown);
    });
    Entry entry{c, true, pass, [this] { return buffers_->read_hits(); }};
    if (c.caster == kOctomap) {
      // Its caster gives stop and key, so the others are compared with it. What is timed is castRay alone,
      // which does not compute them.
      reference_ = entry;
      entry.read = [this] { return buffers_->read_castray(); };
      entry.pass = cast([this](const RayBatch& batch, std::size_t b) {
        cast_ray_loop(subject_.tree, batch.rays, batch.unknown, buffers_->castray[b]);
      });
    }
    entries_.push_back(std::move(entry));
  }
}

void Trial::add_cast_single() {
  const RayBatch& batch = workload_.batches.front();
  for (const Contender& c : subject_.contenders) {
    const auto pass = [this, &batch, &c] {
      CastRayAnswers& answers = buffers_->castray.front();
      if (c.caster == kOctomap)
        cast_ray_loop(subject_.tree, batch.rays, batch.unknown, answers);
      else if (c.caster == kFast)
        cast_ray_loop(*subject_.drop_in, batch.rays, batch.unknown, answers);
      else
        cast_ray_loop(*c.rays, batch.rays, batch.unknown, answers);
    };
    entries_.push_back({c, true, pass, [this] { return buffers_->read_castray(); }});
  }
  reference_ = entries_.front();
}

bool Trial::check(std::span<const int> threads, std::ostream& out) {
  const std::size_t rays = workload_.size();
  buffers_->clear();
  tbb::task_arena(threads.back()).execute(reference_.pass);
  const std::vector<Answer> expected = reference_.read();
  std::size_t positive = 0;
  for (const Answer& answer : expected) positive += answer.positive ? 1 : 0;
  positive_fraction_ = static_cast<double>(positive) / static_cast<double>(rays);

  std::string agreements, complaints;
  for (Entry& entry : entries_) {
    std::size_t differing = 0;
    for (const int count : threads) {
      buffers_->clear();
      tbb::task_arena(count).execute(entry.pass);
      const std::vector<Answer> answers = entry.read();
      std::size_t differing_here = 0;
      for (std::size_t i = 0; i < rays; ++i) {
        if (same(answers[i], expected[i])) continue;
        if (entry.must_agree && differing == 0 && differing_here == 0)
          complaints += "  DISAGREEMENT, " + entry.caster + format(" on %d threads, ", count) +
                        describe_ray(i) + "\n    answered " + describe(answers[i]) + "\n    expected " +
                        describe(expected[i]) + "\n";
        ++differing_here;
      }
      differing = std::max(differing, differing_here);
    }
    entry.agreement = 1.0 - static_cast<double>(differing) / static_cast<double>(rays);
    agreements += format("; %s: %zu differ", entry.caster.c_str(), differing);
    if (!entry.must_agree)
      agreements += format(" (%.3f %%%s)", 100 * (1 - entry.agreement),
                           entry.caster == kOctomap ? ", by rounding" : "");
  }
  out << format("  %-12s %7zu rays, %.1f voxels each, %.1f %% %s", workload_.name.c_str(), rays, mean_voxels_,
                100 * positive_fraction_, workload_.segments.empty() ? "hit" : "visible")
      << agreements << '\n'
      << complaints;
  return complaints.empty();
}

std::string Trial::describe_ray(std::size_t index) const {
  if (!workload_.segments.empty()) {
    const KeySegment& s = workload_.segments[index];
    return format("segment %zu from key %d %d %d to %d %d %d", index, s.from.x, s.from.y, s.from.z, s.to.x,
                  s.to.y, s.to.z);
  }
  std::size_t rest = index, b = 0;
  while (rest >= workload_.batches[b].rays.size()) rest -= workload_.batches[b++].rays.size();
  const Ray& ray = workload_.batches[b].rays[rest];
  const auto d = [](float f) { return static_cast<double>(f); };
  return format("ray %zu from %.9g %.9g %.9g along %.9g %.9g %.9g within %.9g m, unknown voxels %s", index,
                d(ray.origin.x()), d(ray.origin.y()), d(ray.origin.z()), d(ray.direction.x()),
                d(ray.direction.y()), d(ray.direction.z()), ray.max_range,
                workload_.batches[b].unknown == UnknownPolicy::kBlock ? "block" : "pass");
}

}  // namespace frontlux::bench
