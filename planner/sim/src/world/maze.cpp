#include "world/building.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace frontlux::sim {
namespace {

constexpr int kCells = 14, kSize = 400, kHeight = 30, kWall = 2;
constexpr int kNarrow = 24, kWide = 30;  // corridors
constexpr int kLowWall = 13;             // only the UAV gets over it
constexpr int kTunnels = 8;

struct Cell {
  int i = 0, j = 0;
  friend bool operator==(const Cell&, const Cell&) = default;
};
constexpr std::array<Cell, 4> kSteps = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
Cell next_to(Cell c, std::size_t step) { return {c.i + kSteps[step].i, c.j + kSteps[step].j}; }
bool inside(Cell c) { return c.i >= 0 && c.i < kCells && c.j >= 0 && c.j < kCells; }

// Widths from kNarrow to kWide that, with walls between them, fill the size.
std::vector<Span> corridors(LayoutRandom& random) {
  std::vector<int> width(kCells, kNarrow);
  random.widen(width, kWide, kSize - kWall * (kCells - 1) - kNarrow * kCells);
  std::vector<Span> spans;
  int at = 0;
  for (const int w : width) {
    spans.push_back({at, at + w});
    at += w + kWall;
  }
  return spans;
}

class Maze {
 public:
  explicit Maze(std::uint64_t seed)
      : random_(seed), columns_(corridors(random_)), rows_(corridors(random_)), cells_(kCells * kCells) {}

  Building build() {
    const Cell start{random_.chance(50) ? 0 : kCells - 1, random_.chance(50) ? 0 : kCells - 1};
    grow_from(start);
    Building building;
    building.inside = {{0, kSize}, {0, kSize}};
    Solid& solid = building.solid;
    solid.add({-3, kSize + 3}, {-3, kSize + 3}, {-3, kHeight + 3});
    for (int i = 0; i < kCells; ++i)
      for (int j = 0; j < kCells; ++j) {
        solid.cut(rect_of({i, j}), {0, kHeight});
        for (std::size_t step = 0; step < 2; ++step)
          if (at({i, j}).open[step]) solid.cut(wall_between({i, j}, step), {0, kHeight});
      }
    open_chambers(solid, start);
    dig_tunnels(solid, start);
    open_walls(solid);
    building.start = rect_of(start).middle();
    return building;
  }

 private:
  struct State {
    bool reached = false;
    bool tunnel = false;
    std::array<bool, 4> open{};  // by step
  };

  State& at(Cell c) { return cells_[static_cast<std::size_t>(c.i * kCells + c.j)]; }
  [[nodiscard]] Rect rect_of(Cell c) const {
    return {columns_[static_cast<std::size_t>(c.i)], rows_[static_cast<std::size_t>(c.j)]};
  }
  [[nodiscard]] Rect wall_between(Cell c, std::size_t step) const {
    const Rect a = rect_of(c), b = rect_of(next_to(c, step));
    const auto gap = [](Span p, Span q) {
      return p.from == q.from ? p : Span{std::min(p.to, q.to), std::max(p.from, q.from)};
    };
    return {gap(a.x, b.x), gap(a.y, b.y)};
  }
  void open(Cell c, std::size_t step) {
    at(c).open[step] = true;
    at(next_to(c, step)).open[(step + 2) % 4] = true;
  }
  [[nodiscard]] int exits_of(Cell c) {
    return static_cast<int>(std::count(at(c).open.begin(), at(c).open.end(), true));
  }

  // Passages without loops that reach every cell.
  void grow_from(Cell start) {
    std::vector<Cell> trail = {start};
    at(start).reached = true;
    while (!trail.empty()) {
      const Cell here = trail.back();
      std::vector<std::size_t> steps;
      for (std::size_t step = 0; step < 4; ++step)
        if (inside(next_to(here, step)) && !at(next_to(here, step)).reached) steps.push_back(step);
      if (steps.empty()) {
        trail.pop_back();
        continue;
      }
      const auto step = steps[static_cast<std::size_t>(random_.whole(0, static_cast<int>(steps.size()) - 1))];
      open(here, step);
      at(next_to(here, step)).reached = true;
      trail.push_back(next_to(here, step));
    }
  }

  // Squares of four cells without walls, with a crate or a pillar in the middle of some.
  void open_chambers(Solid& solid, Cell start) {
    for (int n = 0; n < 3; ++n) {
      const Cell low{random_.whole(1, kCells - 3), random_.whole(1, kCells - 3)};
      const Rect from = rect_of(low), to = rect_of({low.i + 1, low.j + 1});
      solid.cut({from.x.from, to.x.to}, {from.y.from, to.y.to}, {0, kHeight});
      open(low, 0);
      open(low, 1);
      open({low.i + 1, low.j}, 1);
      open({low.i, low.j + 1}, 0);
      if (low == start || !random_.chance(70)) continue;
      solid.add(Span{from.x.to, to.x.from}.grown(2), Span{from.y.to, to.y.from}.grown(2),
                {0, random_.chance(50) ? kHeight : 12});
    }
  }

  // Dead ends that become low and get a second exit: shortcuts for the UGV alone. No cell lies behind one.
  void dig_tunnels(Solid& solid, Cell start) {
    std::vector<Cell> ends;
    for (int i = 0; i < kCells; ++i)
      for (int j = 0; j < kCells; ++j)
        if (exits_of({i, j}) == 1 && Cell{i, j} != start) ends.push_back({i, j});
    for (int n = 0; n < kTunnels && !ends.empty(); ++n) {
      const auto pick = ends.begin() + random_.whole(0, static_cast<int>(ends.size()) - 1);
      const Cell cell = *pick;
      ends.erase(pick);
      if (exits_of(cell) != 1) continue;  // a tunnel ends here
      const auto& exits = at(cell).open;
      const auto entrance =
          static_cast<std::size_t>(std::find(exits.begin(), exits.end(), true) - exits.begin());
      const int height = random_.whole(10, 12);
      solid.add(rect_of(cell), {height, kHeight});
      solid.add(wall_between(cell, entrance), {height, kHeight});
      at(cell).tunnel = true;
      for (const std::size_t turn : {2U, 1U, 3U}) {  // straight on, if there is something
        const auto exit = (entrance + turn) % 4;
        const Cell beyond = next_to(cell, exit);
        if (!inside(beyond) || at(beyond).tunnel) continue;
        solid.cut(wall_between(cell, exit), {0, height});
        open(cell, exit);
        break;
      }
    }
  }

  // Loops: walls taken away, and walls that only the UAV gets over.
  void open_walls(Solid& solid) {
    for (int i = 0; i < kCells; ++i)
      for (int j = 0; j < kCells; ++j)
        for (std::size_t step = 0; step < 2; ++step) {
          const Cell here{i, j}, there = next_to(here, step);
          const int draw = random_.whole(1, 100);
          if (!inside(there) || at(here).open[step] || at(here).tunnel || at(there).tunnel) continue;
          if (draw <= 7)
            solid.cut(wall_between(here, step), {0, kHeight});
          else if (draw <= 12)
            solid.cut(wall_between(here, step), {kLowWall, kHeight});
        }
  }

  LayoutRandom random_;
  std::vector<Span> columns_, rows_;
  std::vector<State> cells_;
};

}  // namespace

Building build_maze(std::uint64_t seed) { return Maze(seed).build(); }

}  // namespace frontlux::sim
