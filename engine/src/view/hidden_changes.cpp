#include "view/hidden_changes.hpp"

#include <frontlux/parallel.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iterator>
#include <numbers>
#include <vector>

namespace frontlux::detail {
namespace {

constexpr double kRounding = 1e-9;  // far more than rounding can do

// Directions within an octant of the horizon, closed at both ends.
struct Fan {
  bool along_x;        // more than along y
  int step_x, step_y;  // -1 or 1
  int fewest, most;    // steps along the more important axis between two along the other
  double aside;        // at most so long along the other axis, of a ray's length
  int rises;           // at most so many steps along z between two horizontal ones
};

// Of a turn, from `begin` to `end`.
// @param reach, height  [voxels] more steps than these no path has
Fan fan(int octant, double begin, double end, double slope, int reach, int height) {
  const auto direction = [](double turns) {
    return std::array{std::fabs(std::cos(2 * std::numbers::pi * turns)),
                      std::fabs(std::sin(2 * std::numbers::pi * turns))};
  };
  const std::array one = direction(begin), other = direction(end);
  const bool along_x = octant == 0 || octant == 3 || octant == 4 || octant == 7;
  const auto [less, greater] = std::minmax(
      {along_x ? one[1] / one[0] : one[0] / one[1], along_x ? other[1] / other[0] : other[0] / other[1]});
  const double across = reach, up = height;
  return {along_x,
          octant < 2 || octant > 5 ? 1 : -1,
          octant < 4 ? 1 : -1,
          static_cast<int>(std::min(1 / greater - kRounding, across)),
          static_cast<int>(std::ceil(std::min(1 / less + kRounding, across))),
          greater / std::hypot(1.0, greater) + kRounding,
          static_cast<int>(std::ceil(std::min(slope * std::hypot(1.0, greater) + kRounding, up)))};
}

// Columns of voxels in reach of all changes, a bit for each voxel.
template <int kWords>
class Columns {
 public:
  using Column = std::array<std::uint64_t, kWords>;

  Columns(const KeyBox& changes, const KeyBox& box)
      : changes_(changes),
        box_(box),
        rows_(box.max.y - box.min.y + 1),
        open_(static_cast<std::size_t>((box.max.x - box.min.x + 1) * rows_)),
        changed_(open_.size()) {}

  void fill(const VoxelGrid& grid) {
    constexpr int kBrick = 8;
    const auto from = [](int k) { return k / kBrick * kBrick; };
    for (int bx = from(box_.min.x); bx <= box_.max.x; bx += kBrick)
      for (int by = from(box_.min.y); by <= box_.max.y; by += kBrick)
        for (int bz = from(box_.min.z); bz <= box_.max.z; bz += kBrick) {
          const Brick& brick = grid.brick(make_key(bx, by, bz));
          for (int z = bz; z < bz + kBrick; ++z)
            for (std::uint64_t bits = brick.free[static_cast<std::size_t>(z - bz)]; bits != 0;
                 bits &= bits - 1) {
              const int bit = std::countr_zero(bits);
              const VoxelKey key = make_key(bx + bit % kBrick, by + bit / kBrick, z);
              if (box_.contains(key)) word(open_, key) |= mask(key);
            }
        }
  }
  void add_changed(const VoxelKey& key) { word(changed_, key) |= mask(key); }
  void close(const VoxelKey& key) { word(open_, key) &= ~mask(key); }

  [[nodiscard]] const KeyBox& changes() const { return changes_; }
  [[nodiscard]] const KeyBox& box() const { return box_; }
  [[nodiscard]] std::size_t size() const { return open_.size(); }
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>((x - box_.min.x) * rows_ + y - box_.min.y);
  }
  [[nodiscard]] const Column& open(std::size_t index) const { return open_[index]; }
  [[nodiscard]] const Column& changed(std::size_t index) const { return changed_[index]; }
  [[nodiscard]] bool has(const std::vector<Column>& bits, const VoxelKey& key) const {
    return box_.contains(key) && (word(bits, key) & mask(key)) != 0;
  }

 private:
  template <class Bits>
  [[nodiscard]] auto& word(Bits& bits, const VoxelKey& key) const {
    return bits[index(key.x, key.y)][static_cast<std::size_t>((key.z - box_.min.z) / 64)];
  }
  [[nodiscard]] std::uint64_t mask(const VoxelKey& key) const {
    return std::uint64_t{1} << static_cast<unsigned>((key.z - box_.min.z) % 64);
  }

  KeyBox changes_, box_;
  int rows_;
  std::vector<Column> open_, changed_;  // free now and before; changed
};

// The voxels from which a path in a fan leads to a change.
template <int kWords>
class Flood {
 public:
  explicit Flood(const Columns<kWords>& columns, int reach)
      : columns_(columns), reach_(reach), seen_(columns.size()) {}

  [[nodiscard]] bool at(const VoxelKey& key) const { return columns_.has(seen_, key); }
  void clear() { std::fill(seen_.begin(), seen_.end(), Column{}); }

  void add(const Fan& fan) {
    add(fan, [](const Column& column, std::size_t w) {
      return column[w] >> 1U | (w + 1 < kWords ? column[w + 1] << 63U : 0);
    });
    add(fan, [](const Column& column, std::size_t w) {
      return column[w] << 1U | (w > 0 ? column[w - 1] >> 63U : 0);
    });
  }

 private:
  using Column = typename Columns<kWords>::Column;

  // Where paths may begin along an axis, from the farthest place on in their direction.
  struct Line {
    int begin, end, step;
  };
  static Line line(int first_change, int last_change, int length, int direction, int low, int high) {
    if (direction > 0) return {last_change, std::max(first_change - length, low) - 1, -1};
    return {first_change, std::min(last_change + length, high) + 1, 1};
  }

  // Adds those of paths that go up, or down: `moved` moves bits one voxel against them.
  template <class Moved>
  void add(const Fan& fan, const Moved& moved) {
    // By the steps along the important axis since the last one along the other, counted no further than
    // matters.
    const bool bounded = fan.most <= kFewSteps;
    const std::size_t states = static_cast<std::size_t>(bounded ? fan.most : fan.fewest) + 1;
    const auto fewest = static_cast<std::size_t>(fan.fewest);
    const KeyBox &changes = columns_.changes(), &box = columns_.box();
    const int aside = std::min(static_cast<int>(fan.aside * reach_) + 1, reach_);
    const Line along_x =
        line(changes.min.x, changes.max.x, fan.along_x ? reach_ : aside, fan.step_x, box.min.x, box.max.x);
    const Line along_y =
        line(changes.min.y, changes.max.y, fan.along_x ? aside : reach_, fan.step_y, box.min.y, box.max.y);
    const Line &outer = fan.along_x ? along_x : along_y, &inner = fan.along_x ? along_y : along_x;
    const auto slice = static_cast<std::size_t>(std::abs(inner.end - inner.begin) + 1) * states;
    ahead_.assign(slice, {});  // by place on the inner line, after one for what is beyond; by state
    here_.assign(slice, {});
    for (int a = outer.begin; a != outer.end; a += outer.step) {
      const Column* ahead = ahead_.data();
      Column* here = here_.data();
      for (int b = inner.begin; b != inner.end; b += inner.step) {
        const std::size_t index = fan.along_x ? columns_.index(a, b) : columns_.index(b, a);
        const Column open = columns_.open(index), changed = columns_.changed(index);
        const Column beside = *here;
        ahead += states;
        here += states;
        Column any{};
        for (std::size_t s = 0; s < states; ++s) {
          Column path{};
          if (s + 1 < states || !bounded) path = ahead[std::min(s + 1, states - 1)];
          if (s >= fewest) unite(path, beside);
          for (int r = 0; r < fan.rises; ++r) {
            const Column there = from(open, changed, path), before = path;
            for (std::size_t w = 0; w < kWords; ++w) path[w] |= moved(there, w);
            if (path == before) break;
          }
          unite(any, path);
          here[s] = from(open, changed, path);
        }
        unite(seen_[index], any);
      }
      std::swap(here_, ahead_);
    }
  }

  static void unite(Column& one, const Column& other) {
    for (std::size_t w = 0; w < kWords; ++w) one[w] |= other[w];
  }
  static Column from(const Column& open, const Column& changed, const Column& path) {
    Column there;
    for (std::size_t w = 0; w < kWords; ++w) there[w] = changed[w] | (open[w] & path[w]);
    return there;
  }

  static constexpr int kFewSteps = 3;

  const Columns<kWords>& columns_;
  int reach_;
  std::vector<Column> seen_, ahead_, here_;
};

template <int kWords>
void leave_out(const VoxelGrid& grid, std::span<const VoxelKey> changed, std::span<const VoxelKey> targets,
               const KeyBox& changes, const KeyBox& box, const ViewRegion& view, int bins,
               std::span<Onlooker> onlookers) {
  Columns<kWords> columns(changes, box);
  columns.fill(grid);
  for (const VoxelKey& key : changed) {
    columns.add_changed(key);
    columns.close(key);
  }
  for (const VoxelKey& key : targets) columns.add_changed(key);

  const int parts = std::min(bins, SectorSet::kParts), height = box.max.z - box.min.z + 1;
  const auto begin_of = [&](int part) {  // of a turn
    return static_cast<double>((part * bins + parts - 1) / parts) / bins;
  };
  std::vector<std::vector<std::uint8_t>> hidden(static_cast<std::size_t>(parts));
  for_each_range(hidden.size(), [&](std::size_t first, std::size_t last) {
    Flood<kWords> flood(columns, view.reach());
    for (std::size_t p = first; p < last; ++p) {
      const int part = static_cast<int>(p);
      flood.clear();
      for (int octant = 0; octant < 8; ++octant) {
        const double begin = std::max(begin_of(part), octant / 8.0);
        const double end = std::min(begin_of(part + 1), (octant + 1) / 8.0);
        if (end - begin > kRounding) flood.add(fan(octant, begin, end, view.slope(), view.reach(), height));
      }
      hidden[p].assign(onlookers.size(), 0);
      const SectorSet sector = SectorSet::of_part(part);
      for (std::size_t i = 0; i < onlookers.size(); ++i)
        if (onlookers[i].sectors.contains(sector))
          hidden[p][i] = flood.at(cell_of_code(onlookers[i].code)) ? 0 : 1;
    }
  });
  for (std::size_t p = 0; p < hidden.size(); ++p)
    for (std::size_t i = 0; i < onlookers.size(); ++i)
      if (hidden[p][i] != 0) onlookers[i].sectors.remove(SectorSet::of_part(static_cast<int>(p)));
}

}  // namespace

void leave_out_hidden(const VoxelGrid& grid, std::span<const VoxelKey> changed, const TargetIndex& before,
                      const TargetIndex& now, const ViewRegion& view, int bins,
                      std::span<Onlooker> onlookers) {
  std::vector<std::uint64_t> codes;
  std::set_symmetric_difference(before.codes().begin(), before.codes().end(), now.codes().begin(),
                                now.codes().end(), std::back_inserter(codes));
  std::vector<VoxelKey> targets(codes.size());
  std::transform(codes.begin(), codes.end(), targets.begin(), cell_of_code);
  if (changed.empty() && targets.empty()) return;
  const KeyBox changes = changed.empty()   ? bounds_of(targets)
                         : targets.empty() ? bounds_of(changed)
                                           : hull(bounds_of(changed), bounds_of(targets));
  const KeyBox box = grown(changes, view.reach(), view.reach(), view.greatest_height());
  const int height = box.max.z - box.min.z + 1;
  std::size_t sectors = 0;
  for (const Onlooker& onlooker : onlookers) sectors += static_cast<std::size_t>(onlooker.sectors.size());
  if (size_of(box) > 64 * sectors) return;
  if (height <= 64)
    leave_out<1>(grid, changed, targets, changes, box, view, bins, onlookers);
  else if (height <= 128)
    leave_out<2>(grid, changed, targets, changes, box, view, bins, onlookers);
  else if (height <= 256)
    leave_out<4>(grid, changed, targets, changes, box, view, bins, onlookers);
}

}  // namespace frontlux::detail
