#include "tour/travel_graph.hpp"

#include "mapping/sort_once.hpp"
#include "tour/travel_graph_search.hpp"

#include <frontlux/parallel.hpp>

#include <algorithm>
#include <array>
#include <iterator>
#include <unordered_set>
#include <utility>

namespace frontlux::planner::detail {
namespace {

constexpr std::array<std::array<int, 3>, 6> kFaces = {
    {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};

std::vector<std::size_t> set_places(const std::vector<std::uint8_t>& flags) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < flags.size(); ++i)
    if (flags[i] != 0) places.push_back(i);
  return places;
}

}  // namespace

TravelGraph::TravelGraph(const Lattice& lattice, const KeyBox& bounds, int edge, int spacing)
    : lattice_(lattice), edge_(std::clamp(edge, 1, 40)), spacing_(std::clamp(spacing, 1, 40)), part_(bounds) {
  const auto cubes = [this](int low, int high) { return static_cast<std::size_t>((high - low) / edge_ + 1); };
  count_ = {cubes(bounds.min.x, bounds.max.x), cubes(bounds.min.y, bounds.max.y),
            cubes(bounds.min.z, bounds.max.z)};
  cubes_.resize(count_[0] * count_[1] * count_[2]);
  const auto numbers = [this](int low, int high, std::size_t step) {
    std::vector<std::uint32_t> of_keys;
    for (int key = low; key <= high; ++key)
      of_keys.push_back(static_cast<std::uint32_t>(static_cast<std::size_t>((key - low) / edge_) * step));
    return of_keys;
  };
  number_of_ = {numbers(bounds.min.x, bounds.max.x, count_[1] * count_[2]),
                numbers(bounds.min.y, bounds.max.y, count_[2]), numbers(bounds.min.z, bounds.max.z, 1)};
  first_.resize(cubes_.size());
  for (std::size_t i = 0; i < cubes_.size(); ++i) {
    const auto at = [&](std::size_t place, int low) { return low + static_cast<int>(place) * edge_; };
    const VoxelKey corner =
        make_key(at(i / (count_[1] * count_[2]), bounds.min.x), at(i / count_[2] % count_[1], bounds.min.y),
                 at(i % count_[2], bounds.min.z));
    cubes_[i].cells = {corner, make_key(std::min<int>(corner.x + edge_ - 1, bounds.max.x),
                                        std::min<int>(corner.y + edge_ - 1, bounds.max.y),
                                        std::min<int>(corner.z + edge_ - 1, bounds.max.z))};
  }
}

std::size_t TravelGraph::cube_of(const VoxelKey& cell) const {
  const VoxelKey& low = part_.box().min;
  const auto number = [this](std::size_t axis, int key) {
    return number_of_[axis][static_cast<std::size_t>(key)];
  };
  return number(0, cell.x - low.x) + number(1, cell.y - low.y) + number(2, cell.z - low.z);
}

// Calls `visit(number)` for the cubes that meet a box.
template <class Visit>
void TravelGraph::for_each_cube(const KeyBox& box, const Visit& visit) const {
  const auto part = intersection(box, part_.box());
  if (!part) return;
  const auto place = [this](int key, int min) { return (key - min) / edge_; };
  const VoxelKey& low = part_.box().min;
  for (int x = place(part->min.x, low.x); x <= place(part->max.x, low.x); ++x)
    for (int y = place(part->min.y, low.y); y <= place(part->max.y, low.y); ++y)
      for (int z = place(part->min.z, low.z); z <= place(part->max.z, low.z); ++z)
        visit((static_cast<std::size_t>(x) * count_[1] + static_cast<std::size_t>(y)) * count_[2] +
              static_cast<std::size_t>(z));
}

// Finds the parts of a cube, if the robot fits in others of its cells than before.
// @return whether it does
bool TravelGraph::read(Cube& cube, const TravelCorridor& corridor) {
  constexpr std::uint16_t kOpen = 0xFFFF;
  if (all_of(cube.cells, [&](const VoxelKey& key) { return corridor.fits(key) == (part_[key] != 0); }))
    return false;
  cube.centers.clear();
  for_each_key(cube.cells, [&](const VoxelKey& key) { part_[key] = corridor.fits(key) ? kOpen : 0; });
  std::vector<VoxelKey> part;
  for_each_key(cube.cells, [&](const VoxelKey& first) {
    if (part_[first] != kOpen) return;
    const auto number = static_cast<std::uint16_t>(cube.centers.size() + 1);
    part.assign(1, first);
    part_[first] = number;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < part.size(); ++i) {
      const VoxelKey key = part[i];
      sum += lattice_.exact_center(key);
      for (const auto& [x, y, z] : kFaces) {
        const auto next = offset_key(key, x, y, z);
        if (!next || !cube.cells.contains(*next) || part_[*next] != kOpen) continue;
        part_[*next] = number;
        part.push_back(*next);
      }
    }
    cube.centers.push_back(sum / static_cast<double>(part.size()));
  });
  spread(cube);
  return true;
}

void TravelGraph::spread(Cube& cube) const {
  cube.spread.clear();
  std::unordered_set<std::uint64_t> taken;  // smaller cubes and parts
  for_each_key(cube.cells, [&](const VoxelKey& key) {
    if (part_[key] == 0) return;
    const VoxelKey& low = cube.cells.min;
    const auto place = [this](int at, int from) {
      return static_cast<std::uint32_t>((at - from) / spacing_);
    };
    const std::uint64_t smaller = (place(key.x, low.x) * 64 + place(key.y, low.y)) * 64 + place(key.z, low.z);
    if (taken.insert(smaller << 16U | part_[key]).second) cube.spread.push_back(key);
  });
}

std::vector<VoxelKey> TravelGraph::spread_cells(const KeyBox& box) const {
  std::vector<VoxelKey> cells;
  for_each_cube(box, [&](std::size_t cube) {
    std::ranges::copy_if(cubes_[cube].spread, std::back_inserter(cells),
                         [&](const VoxelKey& cell) { return box.contains(cell); });
  });
  return cells;
}

// Finds which parts of a cube touch parts of the cubes after it, along each axis.
void TravelGraph::link(std::size_t index) {
  Cube& cube = cubes_[index];
  cube.links.clear();
  if (cube.centers.empty()) return;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    KeyBox side = cube.cells;
    if (axis == 0) side.min.x = side.max.x;
    if (axis == 1) side.min.y = side.max.y;
    if (axis == 2) side.min.z = side.max.z;
    const auto beyond = offset_key(side.max, kFaces[axis][0], kFaces[axis][1], kFaces[axis][2]);
    if (!beyond || !part_.box().contains(*beyond)) continue;
    const std::size_t other = cube_of(*beyond);
    for_each_key(side, [&](const VoxelKey& key) {
      const VoxelKey next = *offset_key(key, kFaces[axis][0], kFaces[axis][1], kFaces[axis][2]);
      if (part_[key] != 0 && part_[next] != 0)
        cube.links.emplace_back(part_[key] - 1u, name_of(other, part_[next] - 1u));
    });
  }
  sort_once(cube.links);
}

// Calls `visit(name)` for the nodes that touch one.
template <class Visit>
void TravelGraph::for_each_touching(Name name, const Visit& visit) const {
  const std::size_t index = cube_of(name);
  for (const auto& [part, other] : cubes_[index].links)
    if (part == part_of(name)) visit(other);
  for (const std::size_t back : {count_[1] * count_[2], count_[2], std::size_t{1}})
    if (index >= back)
      for (const auto& [part, other] : cubes_[index - back].links)
        if (other == name) visit(name_of(index - back, part));
}

// Connects each node of a cube with its neighbours and with theirs: so a path along a diagonal is about as
// long as it is.
// @return whether an edge is another one than before
bool TravelGraph::connect(std::size_t index) {
  constexpr float kShortest = 1e-3F;  // [m] of parts with the same centre; a path has no edges of no length
  Cube& cube = cubes_[index];
  const std::vector<Cube::Edge> before = std::exchange(cube.edges, {});
  std::vector<Name> touching, near;
  for (std::uint32_t part = 0; part < cube.centers.size(); ++part) {
    const Name name = name_of(index, part);
    touching.clear();
    for_each_touching(name, [&](Name next) { touching.push_back(next); });
    near = touching;
    for (const Name next : touching) for_each_touching(next, [&](Name beyond) { near.push_back(beyond); });
    sort_once(near);
    for (const Name to : near)
      if (to != name)
        cube.edges.push_back(
            {part, to, std::max(kShortest, static_cast<float>((center_of(to) - center_of(name)).norm()))});
  }
  return cube.edges != before;
}

// Calls `visit(number)` for a cube and those that are one or two faces away.
template <class Visit>
void TravelGraph::for_each_as_near_as_two(std::size_t index, const Visit& visit) const {
  constexpr int kMost = 2;
  const auto [x_count, y_count, z_count] = count_;
  const auto x = static_cast<int>(index / (y_count * z_count)),
             y = static_cast<int>(index / z_count % y_count), z = static_cast<int>(index % z_count);
  const auto is_one = [](int at, std::size_t count) { return at >= 0 && at < static_cast<int>(count); };
  for (int dx = -kMost; dx <= kMost; ++dx)
    for (int dy = std::abs(dx) - kMost; dy <= kMost - std::abs(dx); ++dy) {
      const int rest = kMost - std::abs(dx) - std::abs(dy);
      for (int dz = -rest; dz <= rest; ++dz)
        if (is_one(x + dx, x_count) && is_one(y + dy, y_count) && is_one(z + dz, z_count))
          visit((static_cast<std::size_t>(x + dx) * y_count + static_cast<std::size_t>(y + dy)) * z_count +
                static_cast<std::size_t>(z + dz));
    }
}

// Nodes are numbered by their names.
void TravelGraph::number_nodes() {
  names_.clear();
  extent_.reset();
  std::vector<std::size_t> edges_before(cubes_.size());
  std::size_t edges = 0;
  for (std::size_t i = 0; i < cubes_.size(); ++i) {
    const Cube& cube = cubes_[i];
    first_[i] = static_cast<std::uint32_t>(names_.size());
    edges_before[i] = edges;
    edges += cube.edges.size();
    for (std::uint32_t part = 0; part < cube.centers.size(); ++part) names_.push_back(name_of(i, part));
    if (!cube.centers.empty()) extent_ = extent_ ? hull(*extent_, cube.cells) : cube.cells;
  }
  begin_.assign(names_.size() + 1, edges);
  edges_.resize(edges);
  for_each_range(cubes_.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      std::size_t at = edges_before[i];
      auto edge = cubes_[i].edges.begin();
      for (std::uint32_t part = 0; part < cubes_[i].centers.size(); ++part) {
        begin_[first_[i] + part] = at;
        for (; edge != cubes_[i].edges.end() && edge->from == part; ++edge)
          edges_[at++] = {first_[cube_of(edge->to)] + part_of(edge->to), edge->length};
      }
    }
  });
}

void TravelGraph::update(const TravelCorridor& corridor, std::span<const KeyBox> changed) {
  std::vector<std::uint8_t> reads(cubes_.size());
  for (const KeyBox& box : changed) for_each_cube(box, [&](std::size_t cube) { reads[cube] = 1; });
  const std::vector<std::size_t> read_cubes = set_places(reads);
  for_each_index(read_cubes.size(), [&](std::size_t i) {
    reads[read_cubes[i]] = read(cubes_[read_cubes[i]], corridor) ? 1 : 0;
  });
  // A cube's links lead to those after it, and edges to neighbours of neighbours.
  std::vector<std::uint8_t> links = reads, edges(cubes_.size());
  for (const std::size_t i : set_places(reads)) {
    for (const std::size_t back : {count_[1] * count_[2], count_[2], std::size_t{1}})
      if (i >= back) links[i - back] = 1;
    for_each_as_near_as_two(i, [&](std::size_t cube) { edges[cube] = 1; });
  }
  changed_ = std::move(reads);
  const std::vector<std::size_t> linked = set_places(links), connected = set_places(edges);
  if (connected.empty()) return;
  for_each_index(linked.size(), [&](std::size_t i) { link(linked[i]); });
  for_each_index(connected.size(), [&](std::size_t i) {
    if (connect(connected[i])) changed_[connected[i]] = 1;
  });
  number_nodes();
}

std::optional<std::uint32_t> TravelGraph::node(const VoxelKey& cell) const {
  if (!fits(cell)) return std::nullopt;
  return first_[cube_of(cell)] + part_[cell] - 1u;
}

std::vector<double> TravelGraph::distances(std::uint32_t from) const {
  return Search(*this).take_distances(from);
}

void TravelGraph::measure(std::span<Near> places, std::size_t count) const {
  for_each_range(places.size(), [&](std::size_t begin, std::size_t end) {
    Search search(*this);
    for (Near& place : places.subspan(begin, end - begin)) search.measure(place, count);
  });
}

std::vector<std::uint32_t> TravelGraph::path_back(const std::vector<double>& lengths,
                                                  std::uint32_t to) const {
  std::vector<std::uint32_t> nodes{to};
  for (;;) {
    const std::uint32_t node = nodes.back();
    std::uint32_t before = node;
    for (const Edge& edge : edges_of(node))
      if (lengths[edge.to] + static_cast<double>(edge.length) == lengths[node]) before = edge.to;
    if (before == node) return nodes;
    nodes.push_back(before);
  }
}

VoxelKey TravelGraph::middle_cell(std::uint32_t node) const {
  const Cube& cube = cubes_[cube_of(names_[node])];
  const std::uint32_t part = part_of(names_[node]);
  const VoxelKey* best = nullptr;
  double nearest = TourProblem::kNever;
  for (const VoxelKey& cell : cube.spread) {
    const double distance = (lattice_.exact_center(cell) - cube.centers[part]).squaredNorm();
    if (part_[cell] != part + 1 || distance >= nearest) continue;
    nearest = distance;
    best = &cell;
  }
  return *best;  // each part has some
}

std::vector<std::uint32_t> TravelGraph::around_path(const std::vector<double>& lengths,
                                                    std::uint32_t to) const {
  std::vector<std::uint32_t> nodes;
  for (const std::uint32_t node : path_back(lengths, to)) {
    nodes.push_back(node);
    for (const Edge& edge : edges_of(node)) nodes.push_back(edge.to);
  }
  sort_once(nodes);
  return nodes;
}

}  // namespace frontlux::planner::detail
