// What happens to key segments before their walk. Included by packet_walk_body.inl once for each instruction
// set.
//
// They are walked back, from the voxel to be seen to the one that looks. Most of those that are blocked are
// so right before a voxel that is a frontier: it has a free neighbour, but on any side.

// Segments that a walk has to decide.
struct BackwardSegments {
  std::size_t size = 0;
  alignas(64) std::array<PerLine<std::uint32_t>, 3> keys;  // of each segment, two to a word
  alignas(64) PerLine<std::uint32_t> number;               // of the segment
};

// The first and the second key in a word of a KeySegment.
static_assert(sizeof(KeySegment) == 12);
constexpr std::uint32_t kFirstKey = std::endian::native == std::endian::little ? 0 : 16;
constexpr std::uint32_t kSecondKey = 16 - kFirstKey;

// A number for each lane: 0, step, 2 step, ...
template <std::uint32_t kStep>
constexpr auto kLaneNumbers = [] {
  std::array<std::uint32_t, Lanes::kWidth> numbers{};
  for (unsigned lane = 0; lane < Lanes::kWidth; ++lane) numbers[lane] = kStep * lane;
  return numbers;
}();

// Of segments in lanes, along x, y and z.
struct KeysInLanes {
  Lanes::V from[3], to[3];
  Lanes::V length[3];  // of the offset
};

[[gnu::always_inline]] inline void unpack(const Lanes::I words[3], KeysInLanes& keys) {
  const auto key = [&](int word, std::uint32_t shift) {
    return Lanes::as_time(Lanes::both(Lanes::right(words[word], shift), Lanes::whole(0xFFFF)));
  };
  keys.from[0] = key(0, kFirstKey);
  keys.from[1] = key(0, kSecondKey);
  keys.from[2] = key(1, kFirstKey);
  keys.to[0] = key(1, kSecondKey);
  keys.to[1] = key(2, kFirstKey);
  keys.to[2] = key(2, kSecondKey);
  for (int a = 0; a < 3; ++a) {
    const Lanes::V offset = Lanes::subtract(keys.from[a], keys.to[a]);
    keys.length[a] = Lanes::max(offset, Lanes::subtract(Lanes::time(0), offset));
  }
}

// Raises `outside` to how far keys are from a box along any axis.
[[gnu::always_inline]] inline void measure(const Lanes::V keys[3], const KeyBox& box, Lanes::V& outside) {
  const std::array min{box.min.x, box.min.y, box.min.z}, max{box.max.x, box.max.y, box.max.z};
  for (std::size_t a = 0; a < 3; ++a) {
    outside = Lanes::max(outside, Lanes::subtract(Lanes::time(min[a]), keys[a]));
    outside = Lanes::max(outside, Lanes::subtract(keys[a], Lanes::time(max[a])));
  }
}

// The index of the first voxel when walked backward, that next to its start along the longest axis; of a tie
// along x before y before z, as in a step.
[[gnu::always_inline]] inline Lanes::I first_voxel(const OpenVoxels::Layout& layout,
                                                   const KeysInLanes& keys) {
  using V = Lanes::V;
  const V* const length = keys.length;
  const auto y_longer = Lanes::less(length[0], length[1]);
  const auto z_longest = Lanes::less(Lanes::max(length[0], length[1]), length[2]);
  const auto along = [&](std::size_t a) {
    const V step = Lanes::choose(Lanes::less(keys.from[a], keys.to[a]), Lanes::time(-1), Lanes::time(1));
    const V start = Lanes::subtract(keys.to[a], Lanes::time(layout.corner[a]));
    return Lanes::as_whole(a == 0   ? Lanes::add_unless(start, Lanes::any(y_longer, z_longest), step)
                           : a == 1 ? Lanes::add_if(start, Lanes::but_not(y_longer, z_longest), step)
                                    : Lanes::add_if(start, z_longest, step));
  };
  const auto place = [&](std::size_t a) {
    const Lanes::I key = along(a);
    return Lanes::either(Lanes::left(Lanes::both(key, Lanes::whole(7)), static_cast<std::uint32_t>(3 * a)),
                         Lanes::left(Lanes::right(key, 3), layout.shift(a)));
  };
  return Lanes::either(Lanes::either(place(0), place(1)), place(2));
}

// Sorts segments into those that are blocked right at the end, those for `backward` and those that are
// `left`.
// @param ends_in  where segments may end that begin in the table
// @param left     gets the numbers of those that are too long, lie elsewhere or have no length
// @return how many these are
[[gnu::always_inline]] inline std::size_t select_backward(const OpenVoxels& table, const KeyBox& ends_in,
                                                          std::span<const KeySegment> segments,
                                                          BackwardSegments& backward, std::uint16_t* left) {
  using I = Lanes::I;
  using V = Lanes::V;
  constexpr auto kWidth = static_cast<std::size_t>(Lanes::kWidth);
  constexpr std::size_t kTrial = kMaxLines / 8;
  std::size_t left_size = 0;
  bool looks = true;
  I word = Lanes::whole(0), lane_number = word;
  Lanes::expand(word, kAllLanes, kLaneNumbers<3>.data());
  Lanes::expand(lane_number, kAllLanes, kLaneNumbers<1>.data());
  for (std::size_t i = 0; i < segments.size(); i += kWidth) {
    const std::size_t rest = segments.size() - i;
    const unsigned all = rest < kWidth ? (1U << rest) - 1U : kAllLanes;
    const auto words = [&](std::size_t k) {
      return Lanes::gather(reinterpret_cast<const char*>(&segments[i]) + 4 * k, word, Lanes::mask(all));
    };
    const I packed[3] = {words(0), words(1), words(2)};
    KeysInLanes keys;
    unpack(packed, keys);
    const V* const length = keys.length;
    const V longest = Lanes::max(Lanes::max(length[0], length[1]), length[2]);
    const V steps = Lanes::add(Lanes::add(length[0], length[1]), length[2]);
    V unfit = Lanes::subtract(longest, Lanes::time(PacketWalk::kMaxOffset));
    measure(keys.from, table.bounds(), unfit);
    measure(keys.to, ends_in, unfit);
    const auto has_no_length = Lanes::less(steps, Lanes::time(1));
    const unsigned fits = all & ~Lanes::bits(Lanes::any(Lanes::less(Lanes::time(0), unfit), has_no_length));
    unsigned walks = fits;
    if (looks) {
      const I first = first_voxel(table.layout(), keys);
      const auto closed = Lanes::closed(table.words(), first, Lanes::mask(fits));
      walks &= ~Lanes::bits(Lanes::both(closed, Lanes::less(Lanes::time(1), steps)));
    }
    for (std::size_t k = 0; k < 3; ++k) Lanes::compress(&backward.keys[k][backward.size], walks, packed[k]);
    Lanes::compress(&backward.number[backward.size], walks,
                    Lanes::sum(lane_number, Lanes::whole(static_cast<std::uint32_t>(i))));
    backward.size += static_cast<std::size_t>(__builtin_popcount(walks));
    for (unsigned f = all & ~fits; f != 0; f &= f - 1)
      left[left_size++] = static_cast<std::uint16_t>(i + static_cast<std::size_t>(__builtin_ctz(f)));
    if (i + kWidth == kTrial) looks = backward.size + left_size < kTrial - kTrial / 8;
  }
  return left_size;
}

// The lines of segments walked backward, whose time is a whole number: Crossings<int64_t> in 32 bits.
// @return how many steps they have in all
[[gnu::always_inline]] inline std::int32_t lines_of(const OpenVoxels::Layout& layout,
                                                    const BackwardSegments& backward, PacketLines& lines) {
  const auto key = [](std::uint32_t word, std::uint32_t shift) {
    return static_cast<std::int32_t>(word >> shift & 0xFFFFU);
  };
  const auto length = [](std::int32_t d) { return d < 0 ? -d : d; };
  const auto at_least_one = [](std::int32_t d) { return d > 1 ? d : 1; };
  // The axes are written out, and bits make the choices: with a loop over the axes, or with conditions, from
  // which it makes branches, GCC 14 does not vectorise this.
  const auto all_if_zero = [](std::int32_t distance) { return -static_cast<std::int32_t>(distance == 0); };
  const auto time = [&](std::int32_t distance, std::int32_t product) {
    return product | (all_if_zero(distance) & kNever);
  };
  const auto step = [&](std::int32_t distance, std::int32_t product) {
    return 2 * product & ~all_if_zero(distance);
  };
  const auto down = [](std::int32_t d, std::uint32_t bits) {
    return static_cast<std::uint32_t>(d >> 31) & bits;
  };
  lines.size = backward.size;
  std::int32_t steps = 0;
  const std::int32_t corner_x = layout.corner[0], corner_y = layout.corner[1], corner_z = layout.corner[2];
  const std::uint32_t bits_x = layout.bits[0], bits_y = layout.bits[1], bits_z = layout.bits[2];
  const std::uint32_t y_shift = layout.y_shift, z_shift = layout.z_shift;
  for (std::size_t i = 0; i < backward.size; ++i) {
    const std::uint32_t xy = backward.keys[0][i], zx = backward.keys[1][i], yz = backward.keys[2][i];
    const std::int32_t to_x = key(zx, kSecondKey), to_y = key(yz, kFirstKey), to_z = key(yz, kSecondKey);
    const std::int32_t offset_x = key(xy, kFirstKey) - to_x, offset_y = key(xy, kSecondKey) - to_y,
                       offset_z = key(zx, kFirstKey) - to_z;
    const std::int32_t x = length(offset_x), y = length(offset_y), z = length(offset_z);
    const std::int32_t across_x = at_least_one(y) * at_least_one(z),
                       across_y = at_least_one(z) * at_least_one(x),
                       across_z = at_least_one(x) * at_least_one(y);
    lines.t_max[0][i] = time(x, across_x);
    lines.t_max[1][i] = time(y, across_y);
    lines.t_max[2][i] = time(z, across_z);
    lines.t_delta[0][i] = step(x, across_x);
    lines.t_delta[1][i] = step(y, across_y);
    lines.t_delta[2][i] = step(z, across_z);
    lines.steps[i] = x + y + z;
    steps += lines.steps[i];
    const std::uint32_t flip = down(offset_x, bits_x) | down(offset_y, bits_y) | down(offset_z, bits_z);
    const auto kx = static_cast<std::uint32_t>(to_x - corner_x),
               ky = static_cast<std::uint32_t>(to_y - corner_y),
               kz = static_cast<std::uint32_t>(to_z - corner_z);
    const std::uint32_t index = (kx & 7U) | (ky & 7U) << 3U | (kz & 7U) << 6U | (kx >> 3U) << 9U |
                                (ky >> 3U) << y_shift | (kz >> 3U) << z_shift;
    lines.index[i] = index ^ flip;
    lines.flip[i] = flip;
  }
  return steps;
}
