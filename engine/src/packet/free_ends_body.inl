// Where rays of a batch end that no voxel stops in their range: find_free_end for all of them at once, in
// loops that the compiler vectorises. Included by packet_walk_body.inl once for each instruction set.

// Those that it cannot tell for sure, or not in a few steps, stay as they are, and so do those of a range so
// short that a voxel before its end is before their origin.
inline void find_free_ends(const Lattice& lattice, RayBatch& batch) {
  const double resolution = lattice.resolution(), factor = lattice.voxels_per_metre();
  alignas(64) PerLine<std::uint32_t> number;
  std::size_t size = 0;
  for (std::size_t i = 0; i < batch.size; ++i) {
    const std::uint32_t at = batch.stopped_at[i];
    const double range = batch.max_range[i];
    const bool free = at < kFirstWalkEnd ? batch.in_range[i] == kOutOfRange
                                         : at == kWentThrough && is_walked_whole(range, resolution);
    number[size] = static_cast<std::uint32_t>(i);
    size += free && range > resolution ? 1 : 0;
  }
  if (size == 0) return;

  // What find_free_end knows of a ray, but that voxels are counted from key `Lattice::kOrigin`. Flags are 0
  // and 1.
  alignas(64) PerAxisAndLine<double> cell, step, t, between, error;
  alignas(64) PerAxisAndLine<float> origin;
  alignas(64) PerLine<double> range, distance_sq, going, unsure;
  FRONTLUX_NO_GATHERS
  for (std::size_t j = 0; j < size; ++j) {
    range[j] = batch.max_range[number[j]];
    going[j] = 1.0;
    unsure[j] = 0.0;
  }
  for (std::size_t a = 0; a < 3; ++a) {
    alignas(64) PerLine<double> direction;
    FRONTLUX_NO_GATHERS
    for (std::size_t j = 0; j < size; ++j) {
      origin[a][j] = batch.origin[a][number[j]];
      direction[j] = static_cast<double>(batch.direction[a][number[j]]);
    }
    const float* const origins = origin[a].data();
    double *const cells = cell[a].data(), *const steps = step[a].data(), *const times = t[a].data(),
                  *const betweens = between[a].data(), *const errors = error[a].data();
    for (std::size_t j = 0; j < size; ++j) {
      const double d = direction[j], position = factor * static_cast<double>(origins[j]);
      const double last = range[j] * factor, at = position + (last - 1.0) * d;
      const double floor = std::floor(at), inside = at - floor;
      const double clear_of_faces = std::min(inside, 1.0 - inside);
      unsure[j] = d != 0.0 && clear_of_faces < margin_of_entry(last) ? 1.0 : unsure[j];
      const double face = floor + (d > 0.0 ? 1.0 : 0.0), time = (face - position) / d;
      cells[j] = floor;
      steps[j] = std::copysign(1.0, d);
      times[j] = d != 0.0 ? time : std::numeric_limits<double>::infinity();
      betweens[j] = std::fabs(1.0 / d);
      errors[j] = d != 0.0 ? error_of_crossing(betweens[j], last) : 0.0;
    }
  }
  // From a voxel before the end to a centre beyond it are at most 1.9 voxels, which seldom cross more faces.
  constexpr int kEnoughSteps = 5;
  for (int k = 0; k < kEnoughSteps; ++k) {
    for (std::size_t j = 0; j < size; ++j) {
      const double x = t[0][j], y = t[1][j], z = t[2][j];
      const double soonest_x = x - error[0][j], soonest_y = y - error[1][j], soonest_z = z - error[2][j];
      const auto if_first = [](double latest, double a, double b, double go) {
        return latest < std::min(a, b) ? go : 0.0;
      };
      const double go_x = if_first(x + error[0][j], soonest_y, soonest_z, going[j]),
                   go_y = if_first(y + error[1][j], soonest_x, soonest_z, going[j]),
                   go_z = if_first(z + error[2][j], soonest_x, soonest_y, going[j]);
      unsure[j] = go_x + go_y + go_z != going[j] ? 1.0 : unsure[j];
      t[0][j] = go_x != 0.0 ? x + between[0][j] : x;
      t[1][j] = go_y != 0.0 ? y + between[1][j] : y;
      t[2][j] = go_z != 0.0 ? z + between[2][j] : z;
      cell[0][j] += go_x * step[0][j];
      cell[1][j] += go_y * step[1][j];
      cell[2][j] += go_z * step[2][j];
      distance_sq[j] = 0.0;
    }
    for (std::size_t a = 0; a < 3; ++a) {
      const double* const cells = cell[a].data();
      const float* const origins = origin[a].data();
      for (std::size_t j = 0; j < size; ++j) {
        const float offset = static_cast<float>((cells[j] + 0.5) * resolution) - origins[j];
        const float squared = offset * offset;
        distance_sq[j] += static_cast<double>(squared);
      }
    }
    for (std::size_t j = 0; j < size; ++j) going[j] = distance_sq[j] > range[j] * range[j] ? 0.0 : going[j];
  }
  for (std::size_t j = 0; j < size; ++j) {
    bool known = going[j] == 0.0 && unsure[j] == 0.0;
    for (std::size_t a = 0; a < 3; ++a)
      known &= cell[a][j] >= -Lattice::kOrigin && cell[a][j] < Lattice::kKeysPerAxis - Lattice::kOrigin;
    if (!known) continue;
    const std::size_t i = number[j];
    batch.stopped_at[i] = kFreeEnd;
    for (std::size_t a = 0; a < 3; ++a) {
      batch.cell[a][i] = static_cast<std::int32_t>(cell[a][j]) + Lattice::kOrigin;
      batch.end[a][i] = static_cast<float>((cell[a][j] + 0.5) * resolution);
    }
  }
}
