#include <frontlux/synthetic/random.hpp>
#include <frontlux/synthetic/scanner.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace frontlux::synthetic {
namespace {

constexpr double kSensorHeight = 1.2;  // [m]
constexpr double kClearance = 0.4;     // [m]

octomap::point3d to_octomap(const Eigen::Vector3d& p) {
  return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
}

void require_positive(const char* name, double value) {
  if (value > 0.0 && std::isfinite(value)) return;
  throw std::invalid_argument("scan: " + std::string(name) + " is " + std::to_string(value) +
                              ", must be positive");
}

// Even directions on a Fibonacci lattice. Turned step by step instead of by sin and cos, whose last bit
// depends on the C library and even on the processor it finds itself on.
std::vector<Eigen::Vector3d> even_directions(int count) {
  constexpr double kCosGoldenAngle = -0.7373688780783197, kSinGoldenAngle = 0.6754902942615238;
  std::vector<Eigen::Vector3d> directions;
  directions.reserve(static_cast<std::size_t>(count));
  double c = 1.0, s = 0.0;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count, radius = std::sqrt(1.0 - z * z);
    directions.emplace_back(radius * c, radius * s, z);
    const double turned = c * kCosGoldenAngle - s * kSinGoldenAngle;
    s = s * kCosGoldenAngle + c * kSinGoldenAngle;
    c = turned;
  }
  return directions;
}

// A point on the unit circle.
Eigen::Vector2d draw_turn(Random& random) {
  while (true) {
    const double x = random.between(-1.0, 1.0);
    const double y = random.between(-1.0, 1.0);
    const double square = x * x + y * y;
    if (square < 0.01 || square > 1.0) continue;
    const double length = std::sqrt(square);
    return {x / length, y / length};
  }
}

octomap::ColorOcTreeNode::Color color_of(std::size_t box) {
  const std::uint64_t bits = Random(box).bits();
  return {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8U),
          static_cast<std::uint8_t>(bits >> 16U)};
}

}  // namespace

std::vector<Eigen::Vector3d> draw_places(const Scene& scene, std::size_t count, double spacing,
                                         std::uint64_t seed) {
  Random random(seed, 1);
  std::vector<Eigen::Vector3d> places;
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(kClearance);
  for (std::size_t attempt = 0; attempt < 200 * count && places.size() < count; ++attempt) {
    Eigen::Vector3d place;
    place.x() = random.between(scene.room.min().x(), scene.room.max().x());
    place.y() = random.between(scene.room.min().y(), scene.room.max().y());
    const auto storey = static_cast<std::size_t>(random.whole(0, static_cast<int>(scene.floors.size()) - 1));
    place.z() = scene.floors[storey] + kSensorHeight;
    const bool crowded = std::any_of(places.begin(), places.end(), [&](const Eigen::Vector3d& other) {
      const double dx = other.x() - place.x(), dy = other.y() - place.y();
      return other.z() == place.z() && dx * dx + dy * dy < spacing * spacing;
    });
    if (crowded || scene.solids.overlaps(Box(place - margin, place + margin))) continue;
    // A storey's floor may have a hole, or something standing on it.
    const auto below = scene.solids.first_hit(place, -Eigen::Vector3d::UnitZ());
    if (!below || std::abs(below->distance - kSensorHeight) > 0.01) continue;
    places.push_back(place);
  }
  return places;
}

template <class Tree>
std::unique_ptr<Tree> scan(const Scene& scene, const std::vector<Eigen::Vector3d>& places,
                           const ScanOptions& options, const ScanProgress& progress) {
  require_positive("resolution", options.resolution);
  require_positive("max_range", options.max_range);
  require_positive("rays", options.rays);
  require_positive("beyond_surface", options.beyond_surface);
  auto tree = std::make_unique<Tree>(options.resolution);
  const std::vector<Eigen::Vector3d> directions = even_directions(options.rays);
  Random random(options.seed, 2);
  std::size_t done = 0;
  for (const Eigen::Vector3d& place : places) {
    const Eigen::Vector2d turn = draw_turn(random);
    octomap::Pointcloud points;
    points.reserve(directions.size());
    std::vector<std::size_t> boxes;
    for (const Eigen::Vector3d& d : directions) {
      const Eigen::Vector3d direction(turn.x() * d.x() - turn.y() * d.y(),
                                      turn.y() * d.x() + turn.x() * d.y(), d.z());
      const auto hit = scene.solids.first_hit(place, direction);
      if (hit && hit->distance == 0.0) {
        std::ostringstream what;
        what << "scan: place (" << place.transpose() << ") lies within solid " << hit->box;
        throw std::invalid_argument(what.str());
      }
      // OctoMap clears up to max_range along whatever ends beyond it.
      const double distance = hit ? hit->distance + options.beyond_surface : 2.0 * options.max_range;
      points.push_back(to_octomap(place + distance * direction));
      boxes.push_back(hit && distance <= options.max_range ? hit->box : scene.solids.boxes().size());
    }
    tree->insertPointCloud(points, to_octomap(place), options.max_range, /*lazy_eval=*/true,
                           /*discretize=*/true);
    if constexpr (std::is_same_v<Tree, octomap::ColorOcTree>) {
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (boxes[i] == scene.solids.boxes().size()) continue;
        const auto color = color_of(boxes[i]);
        const octomap::point3d& p = points[static_cast<unsigned>(i)];
        tree->setNodeColor(p.x(), p.y(), p.z(), color.r, color.g, color.b);
      }
    }
    if (progress) progress(++done, places.size());
  }
  tree->updateInnerOccupancy();
  tree->prune();
  return tree;
}

template std::unique_ptr<octomap::OcTree> scan(const Scene&, const std::vector<Eigen::Vector3d>&,
                                               const ScanOptions&, const ScanProgress&);
template std::unique_ptr<octomap::ColorOcTree> scan(const Scene&, const std::vector<Eigen::Vector3d>&,
                                                    const ScanOptions&, const ScanProgress&);

}  // namespace frontlux::synthetic
