// Distances in the travel graph.

#include "tour/travel_graph.hpp"

#include <frontlux/parallel.hpp>

#include <algorithm>
#include <bit>
#include <limits>
#include <queue>
#include <utility>

namespace frontlux::planner::detail {
namespace {

constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();
// Bands that are searched beyond those asked for: after an update the nodes asked for may lie farther away.
constexpr std::size_t kMoreBands = 2;

}  // namespace

double TravelGraph::Near::distance_to(Name name) const {
  const auto found = std::ranges::lower_bound(distances, name, {}, &Distance::to);
  return found != distances.end() && found->to == name && found->length <= farthest ? found->length : kFar;
}

// Dijkstra's algorithm, but nodes about as far as each other, in a band, are taken in any order, and once
// more when they turn out to be nearer. The distances are the only ones that agree with each other along all
// edges: whatever the order, they are the same to the last bit. Searches from several nodes after each other
// pay for what they reach only.
class TravelGraph::Search {
 public:
  explicit Search(const TravelGraph& graph)
      : graph_(graph), lengths_(graph.size(), kFar), marks_(graph.cubes_.size() / 64 + 1) {}

  // [m] to each node
  std::vector<double> all(std::uint32_t from) && {
    begin();
    reach(from, 0.0);
    run(kAll, kAll);
    return std::move(lengths_);
  }

  Near near(const NearQuery& query, std::size_t count) {
    constexpr std::size_t kFew = 4;  // changed nodes, to which others are so many times as many
    if (query.before != nullptr && graph_.changed_nodes_.size() * kFew < query.before->distances.size())
      if (Near near = repaired(*query.before, count); !near.distances.empty()) return near;
    begin();
    reach(query.from, 0.0);
    return nearest(run(kAll, count), count);
  }

 private:
  [[nodiscard]] std::size_t band(double length) const { return static_cast<std::size_t>(length / width_); }

  void begin() {
    for (const std::uint32_t node : reached_) lengths_[node] = kFar;
    reached_.clear();
  }

  // Sets the distance of a node, whose neighbours may be nearer now.
  void reach(std::uint32_t node, double length) {
    if (lengths_[node] == kFar) reached_.push_back(node);
    lengths_[node] = length;
    const std::size_t in = band(length);
    first_ = std::min(first_, in);
    end_ = std::max(end_, in + 1);
    if (end_ > open_.size()) open_.resize(end_);
    open_[in].emplace_back(length, node);
  }

  // Ends after so many bands, or some bands after those in which so many nodes are reached. Nodes farther
  // away are not reached afterwards.
  // @return how many bands are done, `kAll` if there are no more
  std::size_t run(std::size_t bands, std::size_t count) {
    std::size_t known = 0, now = first_;
    for (; now < end_ && now < bands; ++now) {
      for (std::size_t i = 0; i < open_[now].size(); ++i) {
        const auto [so_far, node] = open_[now][i];
        if (so_far > lengths_[node]) continue;
        for (const auto& [to, length] : graph_.nodes_[node].edges)
          if (const double through = so_far + static_cast<double>(length); through < lengths_[to])
            reach(to, through);
      }
      if (known < count) {
        for (const auto& [so_far, node] : open_[now]) known += so_far > lengths_[node] ? 0 : 1;
        if (known >= count) bands = std::min(bands, now + 1 + kMoreBands);
      }
      open_[now].clear();
    }
    const bool ends = now >= end_ && bands == kAll;
    for (std::size_t later = now; later < end_; ++later) open_[later].clear();
    first_ = kAll;
    end_ = 0;
    if (ends) return kAll;
    forget_from(bands);
    return bands;
  }

  void forget_from(std::size_t bands) {
    std::erase_if(reached_, [&](std::uint32_t node) {
      if (lengths_[node] != kFar && band(lengths_[node]) < bands) return false;
      lengths_[node] = kFar;
      return true;
    });
  }

  // The same as a new search finds, from distances before the last update. Only those that went through nodes
  // that have changed, and those that are shorter through such nodes, are found anew.
  // @return nothing if there are fewer nodes than asked for where all are known
  Near repaired(const Near& before, std::size_t count) {
    begin();
    for (const auto& [name, length] : before.distances) {
      if (part_of(name) >= graph_.numbers_[cube_of(name)].parts) continue;
      const std::uint32_t node = graph_.number_of(name);
      lengths_[node] = length;
      reached_.push_back(node);
    }
    lose_what_depends_on_changes();
    for (const std::uint32_t node : lost_) {
      double length = kFar;
      for (const Edge& edge : graph_.nodes_[node].edges)
        length = std::min(length, lengths_[edge.to] + static_cast<double>(edge.length));
      if (length != kFar) reach(node, length);
    }
    run(before.bands, kAll);
    return nearest(before.bands, count);
  }

  // Nodes that have changed, and those to which no other node leads at the distance that they had.
  void lose_what_depends_on_changes() {
    const auto doubt_next_to = [&](std::uint32_t node, double length) {
      for (const Edge& edge : graph_.nodes_[node].edges)
        if (const double next = lengths_[edge.to];
            next != kFar && length + static_cast<double>(edge.length) == next)
          doubted_.emplace(next, edge.to);
    };
    lost_ = graph_.changed_nodes_;
    for (const std::uint32_t node : lost_) doubt_next_to(node, lengths_[node]);
    for (const std::uint32_t node : lost_) lengths_[node] = kFar;
    while (!doubted_.empty()) {  // the nearest first: what leads to a node is certain before
      const auto [length, node] = doubted_.top();
      doubted_.pop();
      if (lengths_[node] == kFar) continue;
      const bool holds = std::ranges::any_of(graph_.nodes_[node].edges, [&](const Edge& edge) {
        return lengths_[edge.to] < length && lengths_[edge.to] + static_cast<double>(edge.length) == length;
      });
      if (holds) continue;
      lengths_[node] = kFar;
      lost_.push_back(node);
      doubt_next_to(node, length);
    }
  }

  // @param bands  in which all nodes are known
  [[nodiscard]] Near nearest(std::size_t bands, std::size_t count) {
    in_band_.clear();
    for (const std::uint32_t node : reached_) {
      const std::size_t cube = cube_of(graph_.name_of(node));
      marks_[cube / 64] |= std::uint64_t{1} << (cube % 64);
    }
    Near near;
    near.distances.reserve(reached_.size());
    for (std::size_t i = 0; i < marks_.size(); ++i)
      for (std::uint64_t rest = std::exchange(marks_[i], 0); rest != 0; rest &= rest - 1) {
        const std::size_t cube = 64 * i + static_cast<std::size_t>(std::countr_zero(rest));
        const auto& [first, parts, room] = graph_.numbers_[cube];
        for (std::uint32_t part = 0; part < parts; ++part)
          if (const double length = lengths_[first + part]; length != kFar)
            near.distances.push_back({name_of(cube, part), length});
      }
    for (const Distance& distance : near.distances) {
      const std::size_t in = band(distance.length);
      if (in >= in_band_.size()) in_band_.resize(in + 1);
      ++in_band_[in];
    }
    std::size_t asked = 0, known = 0;  // bands, nodes in them
    while (asked < in_band_.size() && known < count) known += in_band_[asked++];
    if (known < count && bands != kAll) return {};
    near.bands = known < count ? bands : std::min(bands, asked + kMoreBands);
    std::erase_if(near.distances, [&](const Distance& d) { return band(d.length) >= near.bands; });
    for (const Distance& distance : near.distances)
      if (band(distance.length) < asked) near.farthest = std::max(near.farthest, distance.length);
    return near;
  }

  const TravelGraph& graph_;
  // [m] of nodes about as far as each other
  const double width_ = graph_.edge_ * graph_.lattice_.resolution() / 2;
  std::vector<double> lengths_;
  std::vector<std::uint32_t> reached_;  // some perhaps twice
  std::vector<std::uint64_t> marks_;    // a bit for each cube: sorts the nodes
  std::vector<std::vector<std::pair<double, std::uint32_t>>> open_;
  std::size_t first_ = kAll, end_ = 0;  // bands that are open
  std::vector<std::size_t> in_band_;    // so many nodes
  std::vector<std::uint32_t> lost_;
  using Doubt = std::pair<double, std::uint32_t>;
  std::priority_queue<Doubt, std::vector<Doubt>, std::greater<>> doubted_;
};

std::vector<double> TravelGraph::distances(std::uint32_t from) const { return Search(*this).all(from); }

std::vector<TravelGraph::Near> TravelGraph::near_distances(std::span<const NearQuery> queries,
                                                           std::size_t count) const {
  std::vector<Near> near(queries.size());
  for_each_range(queries.size(), [&](std::size_t begin, std::size_t end) {
    Search search(*this);
    for (std::size_t i = begin; i < end; ++i) near[i] = search.near(queries[i], count);
  });
  return near;
}

}  // namespace frontlux::planner::detail
