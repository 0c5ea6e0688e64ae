// What happens to rays before and after their walk, for a whole batch: loops that the compiler vectorises.
// Included by packet_walk_body.inl once for each instruction set. All arithmetic is that of walk.hpp and
// walk.cpp, operation by operation, until times become whole numbers.

// The end of a ray's time. What a crossing behind it adds still fits into 31 bits.
constexpr std::int32_t kEndOfTime = (1 << 30) - 1;
constexpr std::int32_t kNever = 0x7FFFFFFF;
// Times are cut off to whole numbers, and so is what each step adds, so after n steps a time is up to n + 1
// too small, and so is the difference of two. A ray crosses at most one plane more than voxels it is long.
// castRay's own rounding is far below one.
constexpr std::int32_t kCloseToTell = static_cast<std::int32_t>(kLongestWalk) + 4;

// What is known of a ray before its walk.
constexpr std::uint32_t kStarts = 1;   // in an open voxel of the table, in a direction of unit length
constexpr std::uint32_t kIsClear = 2;  // its first crossings are times to come

inline void take(std::span<const Ray> rays, RayBatch& batch) {
  batch.size = rays.size();
  FRONTLUX_NO_GATHERS
  for (std::size_t i = 0; i < rays.size(); ++i) {
    for (std::size_t a = 0; a < 3; ++a) {
      batch.origin[a][i] = rays[i].origin[static_cast<Eigen::Index>(a)];
      batch.direction[a][i] = rays[i].direction[static_cast<Eigen::Index>(a)];
    }
    batch.max_range[i] = rays[i].max_range;
  }
}

// normalized_as_octomap and is_unit: a root in float is the root in double, rounded to float.
inline void normalize(RayBatch& batch, PerLine<std::uint32_t>& fitness) {
  float *const dx = batch.direction[0].data(), *const dy = batch.direction[1].data(),
               *const dz = batch.direction[2].data();
  for (std::size_t i = 0; i < batch.size; ++i) {
    const float length = std::sqrt(dx[i] * dx[i] + dy[i] * dy[i] + dz[i] * dz[i]);
    const float x = dx[i] / length, y = dy[i] / length, z = dz[i] / length;
    dx[i] = x;
    dy[i] = y;
    dz[i] = z;
    fitness[i] = is_unit(x * x + y * y + z * z) ? kStarts | kIsClear : 0U;
  }
}

// crossings_of and Lattice::key, and where the ray is in the table.
inline void start(const Lattice& lattice, const OpenVoxels& table, const RayBatch& batch, PacketLines& lines,
                  PerLine<std::uint32_t>& fitness) {
  const double resolution = lattice.resolution(), factor = lattice.voxels_per_metre();
  alignas(64) PerLine<double> units;  // of time in a metre
  for (std::size_t i = 0; i < batch.size; ++i) {
    units[i] = kEndOfTime / walked_length(batch.max_range[i], resolution);
    lines.index[i] = lines.flip[i] = 0;
  }
  const OpenVoxels::Layout& layout = table.layout();
  alignas(64) PerLine<std::uint32_t> at_start;  // axes that are crossed too soon to tell from time 0
  at_start.fill(0);
  for (std::size_t a = 0; a < 3; ++a) {
    const double lowest = table.bounds_min(a) - Lattice::kOrigin,
                 highest = table.bounds_max(a) - Lattice::kOrigin;
    const int corner = layout.corner[a] - Lattice::kOrigin;
    const std::uint32_t low_shift = 3U * static_cast<std::uint32_t>(a), high_shift = layout.shift(a),
                        bits = layout.bits[a];
    const float *const origin = batch.origin[a].data(), *const direction = batch.direction[a].data();
    std::int32_t *const t_max = lines.t_max[a].data(), *const t_delta = lines.t_delta[a].data();
    // In small loops: of a larger one GCC makes branches, and then no vectors.
    alignas(64) PerLine<double> cell;
    for (std::size_t i = 0; i < batch.size; ++i) {
      const float o = origin[i];
      const double floor = std::floor(factor * static_cast<double>(o));
      const double below = floor < highest ? floor : highest, inside = below > lowest ? below : lowest;
      fitness[i] &= inside == floor ? kStarts | kIsClear : 0U;
      cell[i] = inside;
    }
    for (std::size_t i = 0; i < batch.size; ++i) {
      const double o = static_cast<double>(origin[i]), d = static_cast<double>(direction[i]);
      const double border = (cell[i] + 0.5) * resolution + std::copysign(0.5 * resolution, d);
      const double time = (border - o) / d * units[i];
      const double first = d != 0.0 ? time : std::numeric_limits<double>::infinity();
      const double between = resolution / std::fabs(d) * units[i];
      fitness[i] &= first < 0.0 ? kStarts : kStarts | kIsClear;  // by rounding, on a face
      t_max[i] = static_cast<std::int32_t>(first < kNever ? std::max(first, 0.0) : kNever);
      at_start[i] += t_max[i] <= kCloseToTell ? 1 : 0;
      t_delta[i] = static_cast<std::int32_t>(between < kEndOfTime + 1.0 ? between : kEndOfTime + 1.0);
    }
    for (std::size_t i = 0; i < batch.size; ++i) {
      const auto at = static_cast<std::uint32_t>(static_cast<std::int32_t>(cell[i]) - corner);
      lines.index[i] |= (at & 7U) << low_shift | (at >> 3U) << high_shift;
      lines.flip[i] |= direction[i] < 0.0F ? bits : 0U;
    }
  }
  // A line that is never walked is over at its first step.
  for (std::size_t i = 0; i < batch.size; ++i) {
    if ((fitness[i] & kStarts) != 0 && table.open(lines.index[i])) {
      lines.index[i] ^= lines.flip[i];
      if (at_start[i] < 2 && (fitness[i] & kIsClear) != 0) continue;
      const auto per_axis = [i](const auto& t) { return std::array{t[0][i], t[1][i], t[2][i]}; };
      std::array<std::int32_t, 3> first = per_axis(lines.t_max);
      if (cross_at_start(table, first, per_axis(lines.t_delta), lines.index[i], lines.flip[i],
                         kCloseToTell)) {
        fitness[i] |= kIsClear;
        for (std::size_t a = 0; a < 3; ++a) lines.t_max[a][i] = first[a];
      }
      continue;
    }
    fitness[i] = 0;
    lines.index[i] = lines.flip[i] = 0;
    for (std::size_t a = 0; a < 3; ++a) lines.t_max[a][i] = kNever;
  }
  lines.size = batch.size;
}

// A rate times a time is never less than the steps in it, in spite of rounding, and more by less than one.
inline void rate_steps(PacketLines& lines) {
  constexpr float kSurely = 1.0F + 0x1p-21F;
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t i = 0; i < lines.size; ++i) {
      const std::int32_t delta = lines.t_delta[a][i];
      lines.rate[a][i] = delta == 0 ? 0.0F : kSurely / static_cast<float>(delta);
    }
}

// The voxels that stopped rays, and whether they are in range.
inline void locate(const Lattice& lattice, const OpenVoxels& table, RayBatch& batch) {
  const double resolution = lattice.resolution();
  const OpenVoxels::Layout& layout = table.layout();
  alignas(64) PerLine<double> distance_sq, origin_sum;
  for (std::size_t i = 0; i < batch.size; ++i) distance_sq[i] = origin_sum[i] = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    const int corner = layout.corner[a];
    const std::uint32_t low_shift = 3U * static_cast<std::uint32_t>(a), high_shift = layout.shift(a),
                        bits = layout.bits[a] & ~511U;
    const float* const origin = batch.origin[a].data();
    std::int32_t* const cells = batch.cell[a].data();
    float* const end = batch.end[a].data();
    for (std::size_t i = 0; i < batch.size; ++i) {
      const std::uint32_t at = batch.stopped_at[i];
      cells[i] = static_cast<std::int32_t>((at >> low_shift & 7U) | (at & bits) >> high_shift << 3U) + corner;
      const double cell = static_cast<double>(cells[i] - Lattice::kOrigin);
      end[i] = static_cast<float>((cell + 0.5) * resolution);
      const float offset = end[i] - origin[i], squared = offset * offset;
      distance_sq[i] += static_cast<double>(squared);
      origin_sum[i] += static_cast<double>(std::fabs(origin[i]));
    }
  }
  for (std::size_t i = 0; i < batch.size; ++i) {
    const double range = batch.max_range[i], sure = range_of_sure_paths(range, origin_sum[i]);
    const int unlimited = range > 0.0 ? 0 : 1, near = distance_sq[i] > sure * sure ? 0 : 1,
              too_far = distance_sq[i] > range * range ? 1 : 0;
    const int in = unlimited | near, close = (in | too_far) ^ 1;
    batch.in_range[i] = static_cast<std::uint8_t>(in * kInRange + close * kCloseToLimit);
  }
}

// make_hit, for rays that ended in a voxel.
inline void end_in_voxels(const Lattice& lattice, RayBatch& batch) {
  const double resolution = lattice.resolution();
  alignas(64) PerLine<double> time;
  for (std::size_t i = 0; i < batch.size; ++i) time[i] = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    const float *const origin = batch.origin[a].data(), *const direction = batch.direction[a].data();
    const std::int32_t* const cells = batch.cell[a].data();
    for (std::size_t i = 0; i < batch.size; ++i) {
      const double cell = static_cast<double>(cells[i] - Lattice::kOrigin);
      const double o = static_cast<double>(origin[i]), d = static_cast<double>(direction[i]);
      const double face = cell + (d < 0.0 ? 1.0 : 0.0);
      const double crossing = (face * resolution - o) / d;
      const double later = crossing > time[i] ? crossing : time[i];
      time[i] = d != 0.0 ? later : time[i];
    }
  }
  for (std::size_t a = 0; a < 3; ++a) {
    const float *const origin = batch.origin[a].data(), *const direction = batch.direction[a].data();
    float* const entry = batch.entry[a].data();
    for (std::size_t i = 0; i < batch.size; ++i)
      entry[i] =
          static_cast<float>(static_cast<double>(origin[i]) + time[i] * static_cast<double>(direction[i]));
  }
  const float *const dx = batch.direction[0].data(), *const dy = batch.direction[1].data(),
                     *const dz = batch.direction[2].data();
  for (std::size_t i = 0; i < batch.size; ++i) {
    const double x = static_cast<double>(dx[i]), y = static_cast<double>(dy[i]),
                 z = static_cast<double>(dz[i]);
    // The sum in the order of `make_hit`.
    batch.distance[i] = static_cast<float>(time[i] * std::sqrt(x * x + y * y + z * z));
  }
}
