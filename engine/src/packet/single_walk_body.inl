// The walk of a single ray. Included by single_walk.cpp once for each instruction set, inside a namespace
// that defines `times_of`.

// Four steps of a ray, one after the other.
class Steps {
 public:
  Steps(const OpenVoxels& table, const Times& times, std::uint32_t flip, int too_close)
      : table_(table), between_(times.between), flip_(flip), too_close_(too_close) {
    for (std::size_t a = 0; a < 3; ++a) others_[a] = static_cast<std::int32_t>(~table.layout().bits[a]);
    others_[3] = ~(others_[0] & others_[1] & others_[2]);
  }

  // @param t      when the ray crosses into the next voxel along each axis
  // @param index  of the voxel where it is, flipped so that every step adds
  // @return what `walk` does, or `kWalksOn` with both moved on
  std::uint32_t walk_on(PerAxis& t, std::uint32_t& index) const {
    // No branch depends on which axis is next. `along` is the index, with the bits of all other axes set.
    PerAxis along = static_cast<std::int32_t>(index) | others_;
    PerAxis surely_over = t + too_close_;
    for (int step = 0; step < 4; ++step) {
      const PerAxis one = __builtin_shufflevector(t, t, 1, 2, 0, 3),
                    other = __builtin_shufflevector(t, t, 2, 0, 1, 3);
      const PerAxis first = (one > surely_over) & (other > surely_over), ahead = between_ & first;
      t += ahead;
      surely_over += ahead;
      along = (along - first) | others_;
      PerAxis all = along & __builtin_shufflevector(along, along, 2, 3, 0, 1);
      all &= __builtin_shufflevector(all, all, 1, 0, 3, 2);
      const auto next = static_cast<std::uint32_t>(all[0]);
      if (next == index) return kTooCloseToTell;  // none was surely first
      index = next;
      if (table_.open(index ^ flip_)) continue;
      const PerAxis entered = (t - between_) & first;  // when, on the axis that it was
      return (entered[0] | entered[1] | entered[2]) > kEndOfTime ? kWentThrough : index ^ flip_;
    }
    return kWalksOn;
  }

 private:
  const OpenVoxels& table_;
  PerAxis between_, others_{};
  std::uint32_t flip_;
  int too_close_;
};

// @tparam Stretch  how it goes on where no cube around it is open
// @return what `LoneWalk::stopped_at` is, or `kTooCloseToTell`
template <class Stretch>
inline std::uint32_t walk(const OpenVoxels& table, const Times& times, std::uint32_t index,
                          std::uint32_t flip, int too_close) {
  const OpenVoxels::Layout& layout = table.layout();
  PerAxis t = times.first;
  const PerAxis d = times.between;
  const Stretch stretch(table, times, flip, too_close);
  while (true) {
    if (const std::uint32_t radius = table.radius(index ^ flip); radius > 1) {
      const auto leaves = [&](std::size_t a) {
        const auto steps = static_cast<int>(4 * radius - 1 - (index >> kLowBit[a] & 3U));
        return t[a] + steps * static_cast<std::int64_t>(d[a]);
      };
      const std::int64_t end = std::min(std::min(leaves(0), leaves(1)), leaves(2));
      if (end > kEndOfTime) return kWentThrough;
      const int until = static_cast<int>(end) - 4 * too_close;
      int closest = kNever;
      for (std::size_t a = 0; a < 3; ++a) {
        const int steps = t[a] > until ? 0 : (until - t[a]) / d[a] + 1;
        if (steps > 0) closest = std::min(closest, (until - t[a]) % d[a]);
        t[a] += steps * d[a];
        closest = std::min(closest, t[a] - until);
        const auto count = static_cast<std::uint32_t>(steps);
        index =
            advanced(index, layout.bits[a], (count & 7U) << kLowBit[a] | (count >> 3U) << layout.shift(a));
      }
      if (closest < too_close) return kTooCloseToTell;
    }
    const std::uint32_t end = stretch.walk_on(t, index);
    if (end != kWalksOn) return end;
    if (std::min(std::min(t[0], t[1]), t[2]) > kEndOfTime) return kWentThrough;
  }
}

template <class Stretch>
LoneWalk walk_alone(const Lattice& lattice, const OpenVoxels& table, const Ray& ray) {
  const auto start = lattice.key(ray.origin);
  if (!start || !table.contains(*start)) return {kNeverStarted, {}, {}};
  const OpenVoxels::Layout& layout = table.layout();
  std::uint32_t index = layout.index(*start);
  const Eigen::Vector3f direction = normalized_as_octomap(ray.direction);
  if (!table.open(index) || !is_unit(direction)) return {kNeverStarted, {}, {}};

  const double resolution = lattice.resolution(), length = walked_length(ray.max_range, resolution);
  std::uint32_t flip = 0;
  for (std::size_t a = 0; a < 3; ++a) flip |= ray.direction[static_cast<int>(a)] < 0.0F ? layout.bits[a] : 0U;
  index ^= flip;
  Times times = times_of(lattice, ray, direction,
                         kEndOfTime / length * static_cast<double>(length_as_octomap(ray.direction)));
  const int too_close = static_cast<int>(length * lattice.voxels_per_metre()) + kRounding;
  const PerAxis& t = times.first;
  const int low = std::min(t[0], t[1]), high = std::max(t[0], t[1]);
  const int first = std::min(low, t[2]), second = std::max(low, std::min(high, t[2]));
  std::uint32_t end = kTooCloseToTell;
  if ((first >= 0 && second > too_close) || times.cross_at_start(table, index, flip, too_close))
    end = walk<Stretch>(table, times, index, flip, too_close);
  if (end == kTooCloseToTell)
    end = walk_exactly(table, crossings_of(lattice, ray.origin, *start, direction),
                       layout.index(*start) ^ flip, flip, length);
  return {end, *start, direction};
}
