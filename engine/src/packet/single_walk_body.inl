// The walk of a single ray. Included by single_walk.cpp once for each instruction set, inside a namespace that
// defines `times_of`.

// @return what `LoneWalk::stopped_at` is, or `kTooCloseToTell`
inline std::uint32_t walk(const OpenVoxels& table, const Times& times, std::uint32_t index,
                          std::uint32_t flip, int too_close) {
  const OpenVoxels::Layout& layout = table.layout();
  PerAxis t = times.first, others{};
  const PerAxis d = times.between;
  for (std::size_t a = 0; a < 3; ++a) others[a] = static_cast<std::int32_t>(~layout.bits[a]);
  others[3] = ~(others[0] & others[1] & others[2]);
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
    // No branch depends on which axis is next. `along` is the index, with the bits of all other axes set.
    PerAxis along = static_cast<std::int32_t>(index) | others;
    PerAxis surely_over = t + too_close;
    for (int step = 0; step < 4; ++step) {
      const PerAxis one = __builtin_shufflevector(t, t, 1, 2, 0, 3),
                    other = __builtin_shufflevector(t, t, 2, 0, 1, 3);
      const PerAxis first = (one > surely_over) & (other > surely_over), ahead = d & first;
      t += ahead;
      surely_over += ahead;
      along = (along - first) | others;
      PerAxis all = along & __builtin_shufflevector(along, along, 2, 3, 0, 1);
      all &= __builtin_shufflevector(all, all, 1, 0, 3, 2);
      const auto next = static_cast<std::uint32_t>(all[0]);
      if (next == index) return kTooCloseToTell;  // none was surely first
      index = next;
      if (table.open(index ^ flip)) continue;
      const PerAxis entered = (t - d) & first;  // when, on the axis that it was
      return (entered[0] | entered[1] | entered[2]) > kEndOfTime ? kWentThrough : index ^ flip;
    }
    if (std::min(std::min(t[0], t[1]), t[2]) > kEndOfTime) return kWentThrough;
  }
}

LoneWalk walk_alone(const Lattice& lattice, const OpenVoxels& table, const Ray& ray) {
  const auto start = lattice.key(ray.origin);
  if (!start || !table.contains(*start)) return {kNeverStarted, {}, {}};
  const OpenVoxels::Layout& layout = table.layout();
  std::uint32_t index = layout.index(*start);
  const Eigen::Vector3f direction = normalized_as_octomap(ray.direction);
  if (!table.open(index) || !is_unit(direction)) return {kNeverStarted, {}, {}};

  const double resolution = lattice.resolution(), length = walked_length(ray.max_range, resolution);
  std::uint32_t flip = 0;
  for (std::size_t a = 0; a < 3; ++a)
    flip |= ray.direction[static_cast<int>(a)] < 0.0F ? layout.bits[a] : 0U;
  index ^= flip;
  const Times times = times_of(lattice, ray, direction,
                               kEndOfTime / length * static_cast<double>(length_as_octomap(ray.direction)));
  // By rounding, a ray that starts on a face may have crossed it before.
  const bool is_clear = (times.first[0] | times.first[1] | times.first[2]) >= 0;
  const int too_close = static_cast<int>(length * lattice.voxels_per_metre()) + kRounding;
  std::uint32_t end = is_clear ? walk(table, times, index, flip, too_close) : kTooCloseToTell;
  if (end == kTooCloseToTell)
    end = walk_exactly(table, crossings_of(lattice, ray.origin, *start, direction), index, flip, length);
  return {end, *start, direction};
}
