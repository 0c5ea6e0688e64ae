// The walk itself. Included by packet_walk.cpp once for each instruction set, inside a namespace that defines
// its `Lanes`.

constexpr unsigned kAllLanes = Lanes::kWidth == 32 ? ~0U : (1U << Lanes::kWidth) - 1U;

#include "packet/free_ends_body.inl"
#include "packet/ray_batch_body.inl"
#include "packet/segment_batch_body.inl"

// A step of all lanes needs no branch. Lanes whose line has ended run on for up to kSteps - 1 steps, which
// the table's border allows, and then stand still until enough of them are to be filled again.
constexpr int kSteps = 8;

struct Packet {
  using V = Lanes::V;
  using I = Lanes::I;
  V tx, ty, tz, dx, dy, dz;
  V steps;              // left, of segments
  Lanes::F rx, ry, rz;  // steps in a unit of time
  V closest;            // the shortest time between two crossings that was one too, of rays
  I index, flip, stopped_at;
};

enum class LineKind : std::uint8_t { kSegment, kRay };

// An `OpenVoxels` as the lanes need it.
struct Table {
  using I = Lanes::I;
  I not_x, not_y, not_z;  // bits of the index
  std::uint32_t x_shift, y_shift, z_shift;
  const void *words, *radii;
};

// How far the cells around are open, in cells; anything but in the lanes of `where`.
[[gnu::always_inline]] inline Lanes::I open_radius(const Table& table, Lanes::I at, Lanes::M where) {
  using I = Lanes::I;
  const I word = Lanes::gather(table.radii, Lanes::right(at, 9), where);
  const I x = Lanes::both(at, Lanes::whole(4)), y = Lanes::both(Lanes::right(at, 2), Lanes::whole(8)),
          z = Lanes::both(Lanes::right(at, 4), Lanes::whole(16));
  return Lanes::both(Lanes::right(word, Lanes::either(Lanes::either(x, y), z)), Lanes::whole(15));
}

// Moves the lanes of `jumping` ahead through the open cube around them, to shortly before they leave it.
// @return the rays that end before; segments then have no steps left
template <LineKind kKind>
[[gnu::always_inline]] inline Lanes::M jump(Packet& p, const Table& table, Lanes::M jumping,
                                            Lanes::I radius) {
  using V = Lanes::V;
  using I = Lanes::I;
  const V zero = Lanes::time(0), one = Lanes::time(1), never = Lanes::time(kNever);
  const V reach = Lanes::subtract(Lanes::as_time(Lanes::left(radius, 2)), one);
  // When the line leaves the cube along an axis, if not along another before.
  const auto leaves = [&](V t, V d, Lanes::F steps_per_time, std::uint32_t low_bit) {
    const I in_cell = Lanes::both(Lanes::right(p.index, low_bit), Lanes::whole(3));
    const V steps = Lanes::subtract(reach, Lanes::as_time(in_cell));
    if constexpr (kKind == LineKind::kSegment)  // fits, as PacketWalk::kMaxOffset says
      return Lanes::add(t, Lanes::multiply(steps, d));
    const V enough = Lanes::add(Lanes::product(Lanes::time(kEndOfTime), steps_per_time), one);
    return Lanes::min_unsigned(Lanes::add(t, Lanes::multiply(Lanes::min(steps, enough), d)), never);
  };
  const V end = Lanes::min(Lanes::min(leaves(p.tx, p.dx, p.rx, 0), leaves(p.ty, p.dy, p.ry, 3)),
                           leaves(p.tz, p.dz, p.rz, 6));
  // Before the crossing that leaves the cube, and not so close to it that the two could be mistaken.
  const V until = Lanes::subtract(end, Lanes::time(kKind == LineKind::kSegment ? 1 : kCloseToTell + 1));
  const auto over = kKind == LineKind::kSegment
                        ? Lanes::none()
                        : Lanes::both(jumping, Lanes::less(Lanes::time(kEndOfTime), end));
  const auto take = [&](V& t, V d, Lanes::F steps_per_time, const I& others, std::uint32_t low_bit,
                        std::uint32_t high_bit) {
    const V since = Lanes::subtract(until, t);
    V steps = Lanes::product(since, steps_per_time);  // never too few; at most one too many
    V rest = Lanes::subtract(since, Lanes::multiply(steps, d));
    const auto too_many = Lanes::less(rest, zero);
    rest = Lanes::add_if(rest, too_many, d);
    steps = Lanes::add_unless(steps, too_many, one);
    steps = Lanes::choose(jumping, Lanes::max(steps, zero), zero);
    if constexpr (kKind == LineKind::kRay)
      p.closest = Lanes::min(p.closest, Lanes::choose(Lanes::but_not(jumping, over),
                                                      Lanes::min(rest, Lanes::subtract(d, rest)), never));
    t = Lanes::add(t, Lanes::multiply(steps, d));
    const I count = Lanes::as_whole(steps);
    const I low = Lanes::left(Lanes::both(count, Lanes::whole(7)), low_bit),
            high = Lanes::left(Lanes::right(count, 3), high_bit);
    p.index =
        Lanes::merge(others, p.index, Lanes::sum(Lanes::either(p.index, others), Lanes::either(low, high)));
    if constexpr (kKind == LineKind::kSegment) p.steps = Lanes::subtract(p.steps, steps);
  };
  take(p.tx, p.dx, p.rx, table.not_x, 0, table.x_shift);
  take(p.ty, p.dy, p.ry, table.not_y, 3, table.y_shift);
  take(p.tz, p.dz, p.rz, table.not_z, 6, table.z_shift);
  return over;
}

template <LineKind kKind, bool kJumps, class Finish>
[[gnu::always_inline]] inline void walk_lines(const OpenVoxels& open, const PacketLines& lines,
                                              const Finish& finish) {
  using V = Lanes::V;
  using I = Lanes::I;
  using M = Lanes::M;
  constexpr int kRefill = Lanes::kWidth > 4 ? Lanes::kWidth / 4 : 1;
  // To look how far it is open around all lanes costs as much as a step, and a jump as much as some. Where
  // looking is in vain it is done less often; segments seldom come far.
  constexpr int kWorthAJump = kKind == LineKind::kSegment ? 2 * kRefill : kRefill;  // lanes
  constexpr int kMaxRoundsBetweenLooks = kKind == LineKind::kSegment ? 15 : 3;
  const OpenVoxels::Layout& layout = open.layout();
  const Table table{Lanes::whole(~layout.bits[0]),
                    Lanes::whole(~layout.bits[1]),
                    Lanes::whole(~layout.bits[2]),
                    layout.shift(0),
                    layout.shift(1),
                    layout.shift(2),
                    open.words(),
                    open.radii()};
  const V end_of_time = Lanes::time(kEndOfTime);

  Packet p{};
  p.tx = p.ty = p.tz = p.dx = p.dy = p.dz = p.steps = p.closest = Lanes::time(0);
  p.rx = p.ry = p.rz = Lanes::F{};
  p.index = p.flip = p.stopped_at = Lanes::whole(0);
  alignas(64) std::uint32_t line[Lanes::kWidth] = {};
  unsigned active = 0;
  std::size_t next = 0;
  int rounds_to_look = 0, rounds_between_looks = 0;
  while (true) {
    const int room = Lanes::kWidth - __builtin_popcount(active);
    if (next < lines.size && room >= kRefill) {
      unsigned fill = ~active & kAllLanes;
      const std::size_t left = lines.size - next;
      while (static_cast<std::size_t>(__builtin_popcount(fill)) > left) fill &= fill - 1;
      Lanes::expand(p.tx, fill, &lines.t_max[0][next]);
      Lanes::expand(p.ty, fill, &lines.t_max[1][next]);
      Lanes::expand(p.tz, fill, &lines.t_max[2][next]);
      Lanes::expand(p.dx, fill, &lines.t_delta[0][next]);
      Lanes::expand(p.dy, fill, &lines.t_delta[1][next]);
      Lanes::expand(p.dz, fill, &lines.t_delta[2][next]);
      if constexpr (kJumps) {
        Lanes::expand(p.rx, fill, &lines.rate[0][next]);
        Lanes::expand(p.ry, fill, &lines.rate[1][next]);
        Lanes::expand(p.rz, fill, &lines.rate[2][next]);
      }
      Lanes::expand(p.index, fill, &lines.index[next]);
      Lanes::expand(p.flip, fill, &lines.flip[next]);
      if constexpr (kKind == LineKind::kSegment) {
        Lanes::expand(p.steps, fill, &lines.steps[next]);
      } else {
        p.closest = Lanes::choose(Lanes::mask(fill), Lanes::time(kNever), p.closest);
        p.stopped_at = Lanes::select(Lanes::mask(fill), Lanes::whole(kWentThrough), p.stopped_at);
      }
      for (unsigned f = fill; f != 0; f &= f - 1) line[__builtin_ctz(f)] = static_cast<std::uint32_t>(next++);
      active |= fill;
    }
    if (active == 0) break;

    const M running = Lanes::mask(active);
    M going = running;          // rays that have not ended
    M blocked = Lanes::none();  // segments that a voxel has stopped
    unsigned ended_bits = 0;
    const auto step = [&]() __attribute__((always_inline)) {
      M goes_on;  // unless it is stopped here
      I others;
      if constexpr (kKind == LineKind::kSegment) {
        p.steps = Lanes::subtract(p.steps, Lanes::time(1));
        goes_on = Lanes::less(Lanes::time(0), p.steps);
        // Ties go to z before y before x (rule 5): walked backward to x before y before z.
        const M y_before_x = Lanes::less(p.ty, p.tx), z_next = Lanes::less(p.tz, Lanes::min(p.tx, p.ty));
        p.tx = Lanes::add_unless(p.tx, Lanes::any(y_before_x, z_next), p.dx);
        p.ty = Lanes::add_if(p.ty, Lanes::but_not(y_before_x, z_next), p.dy);
        p.tz = Lanes::add_if(p.tz, z_next, p.dz);
        others = Lanes::select(z_next, table.not_z, Lanes::select(y_before_x, table.not_y, table.not_x));
      } else {
        // Ties go to z before y before x (rule 5).
        const M x_before_y = Lanes::less(p.tx, p.ty);
        const V first = Lanes::min(p.tx, p.ty);
        const M not_z_next = Lanes::less(first, p.tz);
        const M x_next = Lanes::both(x_before_y, not_z_next), y_next = Lanes::but_not(not_z_next, x_before_y);
        const V now = Lanes::min(first, p.tz);
        goes_on = Lanes::but_not(going, Lanes::less(end_of_time, now));
        const V second = Lanes::max(first, Lanes::min(Lanes::max(p.tx, p.ty), p.tz));
        p.closest = Lanes::min(p.closest, Lanes::subtract(second, now));
        p.tx = Lanes::add_if(p.tx, x_next, p.dx);
        p.ty = Lanes::add_if(p.ty, y_next, p.dy);
        p.tz = Lanes::add_unless(p.tz, not_z_next, p.dz);
        others = Lanes::select(not_z_next, Lanes::select(x_before_y, table.not_x, table.not_y), table.not_z);
      }
      p.index = Lanes::merge(others, p.index, Lanes::increment(Lanes::either(p.index, others)));
      const I at = Lanes::exclusive(p.index, p.flip);
      const M stopped = Lanes::both(goes_on, Lanes::closed(table.words, at, running));
      if constexpr (kKind == LineKind::kSegment) {
        blocked = Lanes::any(blocked, stopped);
      } else {
        p.stopped_at = Lanes::select(stopped, at, p.stopped_at);
        going = Lanes::but_not(goes_on, stopped);
      }
    };
    const auto ended = [&]() __attribute__((always_inline)) {
      const M not_yet =
          kKind == LineKind::kRay ? going : Lanes::but_not(Lanes::less(Lanes::time(0), p.steps), blocked);
      return Lanes::bits(Lanes::but_not(running, not_yet));
    };
    do {
      if (kJumps && rounds_to_look-- == 0) {
        const I radius = open_radius(table, Lanes::exclusive(p.index, p.flip), running);
        const M jumping = Lanes::both(running, Lanes::less(Lanes::time(1), Lanes::as_time(radius)));
        if (__builtin_popcount(Lanes::bits(jumping)) >= kWorthAJump) {
          going = Lanes::but_not(going, jump<kKind>(p, table, jumping, radius));
          step();
          if constexpr (kKind == LineKind::kRay) step();  // for the lanes that could not jump
          ended_bits = ended();
          rounds_to_look = rounds_between_looks = 0;
          continue;
        }
        rounds_between_looks = std::min(2 * rounds_between_looks + 1, kMaxRoundsBetweenLooks);
        rounds_to_look = rounds_between_looks;
      }
#pragma GCC unroll 8
      for (int k = 0; k < kSteps; ++k) step();
      ended_bits = ended();
    } while (ended_bits == 0);
    finish(p, line, ended_bits, Lanes::bits(blocked));
    active &= ~ended_bits;
  }
}

std::size_t segments(const OpenVoxels& table, const KeyBox& ends_in, std::span<const KeySegment> segments,
                     std::uint8_t* visible, std::uint16_t* left) {
  BackwardSegments backward;
  const std::size_t left_size = select_backward(table, ends_in, segments, backward, left);
  std::fill_n(visible, segments.size(), std::uint8_t{0});
  PacketLines lines;
  const std::int32_t steps = lines_of(table.layout(), backward, lines);
  const auto finish = [&](const Packet&, const std::uint32_t* line, unsigned ended, unsigned blocked) {
    for (; ended != 0; ended &= ended - 1) {
      const auto lane = static_cast<unsigned>(__builtin_ctz(ended));
      visible[backward.number[line[lane]]] = static_cast<std::uint8_t>(~(blocked >> lane) & 1U);
    }
  };
  // Short segments end before a jump is worth its price.
  constexpr std::int32_t kWorthJumps = 32;
  if (steps >= kWorthJumps * static_cast<std::int32_t>(backward.size)) {
    rate_steps(lines);
    walk_lines<LineKind::kSegment, true>(table, lines, finish);
  } else {
    walk_lines<LineKind::kSegment, false>(table, lines, finish);
  }
  return left_size;
}

void rays(const Lattice& lattice, const OpenVoxels& table, std::span<const Ray> rays, RayBatch& batch) {
  PacketLines lines;
  alignas(64) PerLine<std::uint32_t> fitness;
  take(rays, batch);
  normalize(batch, fitness);
  start(lattice, table, batch, lines, fitness);
  rate_steps(lines);
  walk_lines<LineKind::kRay, true>(
      table, lines, [&](const Packet& p, const std::uint32_t* line, unsigned ended, unsigned) {
        alignas(64) std::uint32_t at[Lanes::kWidth];
        Lanes::store(at, p.stopped_at);
        const unsigned close = Lanes::bits(Lanes::less(p.closest, Lanes::time(kCloseToTell)));
        for (; ended != 0; ended &= ended - 1) {
          const auto lane = static_cast<unsigned>(__builtin_ctz(ended));
          const std::uint32_t fit = fitness[line[lane]];
          const bool is_close = ((close >> lane) & 1U) != 0;
          batch.stopped_at[line[lane]] = (fit & kStarts) == 0                ? kNeverStarted
                                         : is_close || (fit & kIsClear) == 0 ? kTooCloseToTell
                                                                             : at[lane];
        }
      });
  locate(lattice, table, batch);
  find_free_ends(lattice, batch);
  end_in_voxels(lattice, batch);
}
