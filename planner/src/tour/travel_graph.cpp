#include "tour/travel_graph.hpp"

#include <frontlux/parallel.hpp>

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

namespace frontlux::planner::detail {
namespace {

constexpr std::array<std::array<int, 3>, 6> kFaces = {
    {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};

}  // namespace

TravelGraph::TravelGraph(const Lattice& lattice, const KeyBox& bounds, int edge, int spacing)
    : lattice_(lattice), edge_(std::clamp(edge, 1, 40)), spacing_(std::clamp(spacing, 1, 40)), part_(bounds) {
  const auto cubes = [this](int low, int high) { return static_cast<std::size_t>((high - low) / edge_ + 1); };
  count_ = {cubes(bounds.min.x, bounds.max.x), cubes(bounds.min.y, bounds.max.y),
            cubes(bounds.min.z, bounds.max.z)};
  cubes_.resize(count_[0] * count_[1] * count_[2]);
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
  const auto place = [this](int key, int min) { return static_cast<std::size_t>((key - min) / edge_); };
  return (place(cell.x, low.x) * count_[1] + place(cell.y, low.y)) * count_[2] + place(cell.z, low.z);
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

// Finds the parts of a cube.
void TravelGraph::read(Cube& cube, const TravelCorridor& corridor) {
  constexpr std::uint16_t kOpen = 0xFFFF;
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
}

void TravelGraph::spread(Cube& cube) const {
  cube.spread.clear();
  std::vector<std::pair<std::uint32_t, std::uint16_t>> taken;  // smaller cube and part
  for_each_key(cube.cells, [&](const VoxelKey& key) {
    if (part_[key] == 0) return;
    const VoxelKey& low = cube.cells.min;
    const auto place = [this](int at, int from) {
      return static_cast<std::uint32_t>((at - from) / spacing_);
    };
    const std::pair here{(place(key.x, low.x) * 64 + place(key.y, low.y)) * 64 + place(key.z, low.z),
                         part_[key]};
    if (std::ranges::find(taken, here) != taken.end()) return;
    taken.push_back(here);
    cube.spread.push_back(key);
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
        cube.links.emplace_back(part_[key] - 1u, (std::uint64_t{other} << 16) | (part_[next] - 1u));
    });
  }
  std::ranges::sort(cube.links);
  cube.links.erase(std::unique(cube.links.begin(), cube.links.end()), cube.links.end());
}

// Numbers the nodes, and connects each with its neighbours and with theirs: so a way along a diagonal is
// about as long as it is.
void TravelGraph::connect() {
  centers_.clear();
  extent_.reset();
  for (Cube& cube : cubes_) {
    cube.first = static_cast<std::uint32_t>(centers_.size());
    centers_.insert(centers_.end(), cube.centers.begin(), cube.centers.end());
    if (!cube.centers.empty()) extent_ = extent_ ? hull(*extent_, cube.cells) : cube.cells;
  }
  std::vector<std::vector<std::uint32_t>> touching(centers_.size());
  for (const Cube& cube : cubes_)
    for (const auto& [part, other] : cube.links) {
      const std::uint32_t a = cube.first + part,
                          b = cubes_[other >> 16].first + static_cast<std::uint32_t>(other & 0xFFFF);
      touching[a].push_back(b);
      touching[b].push_back(a);
    }
  begin_.assign(1, 0);
  edges_.clear();
  std::vector<std::uint32_t> near;
  for (std::uint32_t node = 0; node < centers_.size(); ++node) {
    near = touching[node];
    for (const std::uint32_t next : touching[node])
      near.insert(near.end(), touching[next].begin(), touching[next].end());
    std::ranges::sort(near);
    near.erase(std::unique(near.begin(), near.end()), near.end());
    for (const std::uint32_t to : near)
      if (to != node) edges_.push_back({to, static_cast<float>((centers_[to] - centers_[node]).norm())});
    begin_.push_back(edges_.size());
  }
}

void TravelGraph::update(const TravelCorridor& corridor, std::span<const KeyBox> changed) {
  std::vector<std::uint8_t> reads(cubes_.size());
  for (const KeyBox& box : changed) for_each_cube(box, [&](std::size_t cube) { reads[cube] = 1; });
  std::vector<std::size_t> read_cubes;
  std::vector<std::uint8_t> links(cubes_.size(), 0);
  const std::array<std::size_t, 3> step = {count_[1] * count_[2], count_[2], 1};
  for (std::size_t i = 0; i < cubes_.size(); ++i) {
    if (reads[i] == 0) continue;
    read_cubes.push_back(i);
    links[i] = 1;
    for (const std::size_t back : step)
      if (i >= back) links[i - back] = 1;
  }
  if (read_cubes.empty()) return;
  for_each_index(read_cubes.size(), [&](std::size_t i) { read(cubes_[read_cubes[i]], corridor); });
  for_each_index(cubes_.size(), [&](std::size_t i) {
    if (links[i] != 0) link(i);
  });
  connect();
}

std::optional<std::uint32_t> TravelGraph::node(const VoxelKey& cell) const {
  if (!part_.box().contains(cell) || part_[cell] == 0) return std::nullopt;
  return cubes_[cube_of(cell)].first + part_[cell] - 1u;
}

// Dijkstra's algorithm, but nodes about as far as each other are taken in any order, and once more when they
// turn out to be nearer. Ends when the ways to so many are known.
std::vector<double> TravelGraph::distances(std::uint32_t from, std::size_t count) const {
  using Entry = std::pair<double, std::uint32_t>;
  const double width = edge_ * lattice_.resolution() / 2;  // [m] of nodes about as far as each other
  const auto band = [width](double length) { return static_cast<std::size_t>(length / width); };
  std::vector<double> lengths(centers_.size(), kFar);
  std::vector<std::vector<Entry>> open(1);
  lengths[from] = 0.0;
  open[0].emplace_back(0.0, from);
  std::size_t known = 0, now = 0;
  for (; now < open.size() && known < count; ++now) {
    for (std::size_t i = 0; i < open[now].size(); ++i) {
      const auto [so_far, node] = open[now][i];
      if (so_far > lengths[node]) continue;
      for (std::size_t e = begin_[node]; e < begin_[node + 1]; ++e) {
        const auto& [to, length] = edges_[e];
        const double through = so_far + static_cast<double>(length);
        if (through >= lengths[to]) continue;
        lengths[to] = through;
        if (band(through) >= open.size()) open.resize(band(through) + 1);
        open[band(through)].emplace_back(through, to);
      }
    }
    for (const auto& [so_far, node] : open[now]) known += so_far > lengths[node] ? 0 : 1;
    open[now] = {};
  }
  if (now < open.size())
    for (double& length : lengths)
      if (length != kFar && band(length) >= now) length = kFar;
  return lengths;
}

std::vector<TravelGraph::Distance> TravelGraph::near_distances(std::uint32_t from, std::size_t count) const {
  const std::vector<double> lengths = distances(from, count);
  std::vector<Distance> near;
  for (std::uint32_t node = 0; node < lengths.size(); ++node)
    if (lengths[node] != kFar) near.push_back({node, lengths[node]});
  return near;
}

std::vector<std::uint32_t> TravelGraph::around_way(const std::vector<double>& lengths,
                                                   std::uint32_t to) const {
  std::vector<std::uint32_t> nodes;
  for (std::uint32_t node = to;;) {
    nodes.push_back(node);
    std::uint32_t before = node;
    for (std::size_t e = begin_[node]; e < begin_[node + 1]; ++e) {
      nodes.push_back(edges_[e].to);
      if (lengths[edges_[e].to] + static_cast<double>(edges_[e].length) == lengths[node] &&
          lengths[edges_[e].to] < lengths[node])
        before = edges_[e].to;
    }
    if (before == node) break;
    node = before;
  }
  std::ranges::sort(nodes);
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

}  // namespace frontlux::planner::detail
