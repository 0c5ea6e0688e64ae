#include "sensing/ray_frame.hpp"

#include <frontlux/floating_point_mode.hpp>
#include <frontlux/parallel.hpp>
#include <frontlux/sim/surface.hpp>
#include <frontlux/thread_sanitizer.hpp>

#if FRONTLUX_EMBREE == 3
#include <embree3/rtcore.h>
#else
#include <embree4/rtcore.h>
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

namespace frontlux::sim {
namespace {

// The triangles, and the frame in which Embree sees them: about the middle, where floats are best.
struct Geometry {
  std::vector<Corners> triangles;
  Eigen::AlignedBox3d box;                           // around them, with some room
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // of the box
  double pad = 0.0;                                  // [m] on each side of a triangle's bounds

  explicit Geometry(const TriangleMesh& mesh) {
    triangles.reserve(mesh.triangles.size());
    for (const auto& [a, b, c] : mesh.triangles)
      triangles.push_back({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]});
    if (triangles.empty()) return;
    box = bounds_of(mesh);
    middle = box.center();
    // A coordinate of at most `reach` is off by reach * 2^-24. Some ten operations lie between a ray and the
    // box of a node, and Embree does them in its fast way for geometry that is not its own; this leaves room
    // for 32 such errors.
    const double reach = std::max(box.sizes().maxCoeff(), 1e-3);
    pad = std::ldexp(reach, -19);
    const Eigen::Vector3d room = Eigen::Vector3d::Constant(std::ldexp(reach, -10));
    box = Eigen::AlignedBox3d(box.min() - room, box.max() + room);
  }
};

constexpr unsigned kLanes = 8;  // rays of a packet, where Embree traverses such; else they go one by one

// One ray of a packet.
struct Lane {
  RayFrame frame;
  double length = 1.0;   // of the direction
  double start = 0.0;    // where Embree's ray starts, in lengths of the direction
  double nearest = 0.0;  // hit so far, or how far to look, in the same
  std::uint32_t triangle = Surface::kNone;
};

// What a query hands to the callback. Embree's hierarchy only finds the triangles that may be hit.
struct Query {
#if FRONTLUX_EMBREE == 3
  RTCIntersectContext embree;  // first: callbacks get a pointer to it
#else
  RTCRayQueryContext embree;
  RTCIntersectArguments arguments;
#endif
  Lane* lanes;  // by the rays' ids

  Query(Lane* of, bool packets) : lanes(of) {
#if FRONTLUX_EMBREE == 3
    rtcInitIntersectContext(&embree);
    if (packets) embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
#else
    rtcInitRayQueryContext(&embree);
    rtcInitIntersectArguments(&arguments);
    arguments.context = &embree;
    if (packets) arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
#endif
  }

#if FRONTLUX_EMBREE == 3
  void intersect(RTCScene scene, const int* valid, RTCRayHit8& packet) {
    rtcIntersect8(valid, scene, &embree, &packet);
  }
  void intersect(RTCScene scene, RTCRayHit& ray) { rtcIntersect1(scene, &embree, &ray); }
#else
  void intersect(RTCScene scene, const int* valid, RTCRayHit8& packet) {
    rtcIntersect8(valid, scene, &packet, &arguments);
  }
  void intersect(RTCScene scene, RTCRayHit& ray) { rtcIntersect1(scene, &ray, &arguments); }
#endif
};

// A little more, so that Embree's single precision loses nothing, and never 0, where a packet finds nothing.
// Rounding may make a length negative.
float widened(double length) { return static_cast<float>(std::max(length * (1.0 + 0x1p-20), 1e-30)); }

void bounds_callback(const RTCBoundsFunctionArguments* args) {
  const auto& geometry = *static_cast<const Geometry*>(args->geometryUserPtr);
  detail::take_over(&geometry);
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& corner : geometry.triangles[args->primID])
    box.extend(corner.cast<double>() - geometry.middle);
  const Eigen::Array3f low = (box.min().array() - geometry.pad).cast<float>(),
                       high = (box.max().array() + geometry.pad).cast<float>();
  RTCBounds& bounds = *args->bounds_o;
  bounds.lower_x = low.x();
  bounds.lower_y = low.y();
  bounds.lower_z = low.z();
  bounds.upper_x = high.x();
  bounds.upper_y = high.y();
  bounds.upper_z = high.z();
  detail::hand_over(&geometry.pad);  // another address: callbacks are in no order among themselves
}

// Embree may hand over a part of a packet.
void intersect_callback(const RTCIntersectFunctionNArguments* args) {
  auto& query = *reinterpret_cast<Query*>(args->context);
  const Corners& corners = static_cast<const Geometry*>(args->geometryUserPtr)->triangles[args->primID];
  RTCRayN* rays = RTCRayHitN_RayN(args->rayhit, args->N);
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] == 0) continue;
    Lane& lane = query.lanes[RTCRayN_id(rays, args->N, i)];
    const auto t = lane.frame.hit(corners);
    if (!t || !(*t >= 0.0 && *t <= lane.nearest)) continue;
    if (*t == lane.nearest && lane.triangle <= args->primID) continue;
    lane.nearest = *t;
    lane.triangle = args->primID;
    RTCRayN_tfar(rays, args->N, i) = widened(*t - lane.start);
  }
}

// One ray of a packet.
RTCRayHit ray_of(const RTCRay8& rays, unsigned i) {
  RTCRayHit one{};
  one.ray = {rays.org_x[i], rays.org_y[i], rays.org_z[i], 0.0F, rays.dir_x[i], rays.dir_y[i],
             rays.dir_z[i], 0.0F,          rays.tfar[i],  ~0U,  rays.id[i],    0};
  one.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  one.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return one;
}

void check_ray(const Surface::Ray& ray, std::size_t index) {
  const auto refuse = [&](const char* what) {
    throw std::invalid_argument("surface: ray " + std::to_string(index) + " has " + what);
  };
  if (!ray.origin.allFinite()) refuse("an origin that is not finite");
  if (!ray.direction.allFinite()) refuse("a direction that is not finite");
  if (ray.direction.isZero(0.0F)) refuse("a direction without length");
  if (!(ray.max_range >= 0.0)) refuse("a max_range that is negative or not a number");
}

}  // namespace

struct Surface::Scene {
  Geometry mesh;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  bool packets = false;  // whether Embree traverses them here: those that it takes apart lose their ids

  explicit Scene(const TriangleMesh& triangle_mesh) : mesh(triangle_mesh) {}
  ~Scene() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  void build() {
    const FloatingPointMode mode(FloatingPointMode::kFlushed);
    device = rtcNewDevice(nullptr);
    if (device == nullptr && rtcGetDeviceError(nullptr) == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
    if (device == nullptr) throw std::runtime_error("Embree cannot make a device on this machine");
    packets = rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) != 0;
    scene = rtcNewScene(device);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(mesh.triangles.size()));
    rtcSetGeometryUserData(geometry, &mesh);
    rtcSetGeometryBoundsFunction(geometry, &bounds_callback, nullptr);
    rtcSetGeometryIntersectFunction(geometry, &intersect_callback);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    detail::hand_over(&mesh);
    rtcCommitScene(scene);
    detail::take_over(&mesh.pad);
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
    if (error != RTC_ERROR_NONE)
      throw std::runtime_error("Embree cannot build a scene of " + std::to_string(mesh.triangles.size()) +
                               " triangles (error " + std::to_string(error) + ")");
  }

  // Whether the ray may hit anything.
  bool set_lane(const Ray& ray, unsigned i, Lane& lane, RTCRayHit8& packet) const {
    // To about unit length by a power of two, which is exact: Embree has no room for tiny and huge numbers.
    int exponent = 0;
    std::frexp(ray.direction.cwiseAbs().maxCoeff(), &exponent);
    const Eigen::Vector3d direction = ray.direction.cast<double>() * std::ldexp(1.0, -exponent);
    const Eigen::Vector3d origin = ray.origin.cast<double>();
    const double length = direction.norm();
    double start = 0.0, end = ray.max_range / length;
    for (int axis = 0; axis < 3; ++axis) {
      // NaN, from 0 / 0, does not count; outside a slab that the ray runs along, one of the two is infinite.
      const double a = (mesh.box.min()[axis] - origin[axis]) / direction[axis];
      const double b = (mesh.box.max()[axis] - origin[axis]) / direction[axis];
      start = std::max(start, std::min(a, b));
      end = std::min(end, std::max(a, b));
    }
    if (!(start <= end)) return false;
    lane = {RayFrame(origin, direction), length, start, end, kNone};
    // A component so small that its inverse overflows moves the ray by less than the boxes are padded.
    const auto component = [&](Eigen::Index axis) {
      return std::fabs(direction[axis]) < 1e-18 ? 0.0F : static_cast<float>(direction[axis]);
    };
    const Eigen::Vector3f local = (origin + start * direction - mesh.middle).cast<float>();
    RTCRay8& rays = packet.ray;
    rays.org_x[i] = local.x();
    rays.org_y[i] = local.y();
    rays.org_z[i] = local.z();
    rays.dir_x[i] = component(0);
    rays.dir_y[i] = component(1);
    rays.dir_z[i] = component(2);
    rays.tfar[i] = widened(end - start);
    rays.mask[i] = ~0U;
    rays.id[i] = i;
    packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    return true;
  }

  // Of at most kLanes rays.
  void first(std::span<const Ray> rays, std::span<Hit> hits) const {
    std::array<Lane, kLanes> lanes;
    RTCRayHit8 packet{};
    alignas(32) std::array<int, kLanes> valid{};
    for (unsigned i = 0; i < kLanes; ++i) {
      const bool may_hit = i < rays.size() && set_lane(rays[i], i, lanes[i], packet);
      valid[i] = may_hit ? -1 : 0;
      if (!may_hit) packet.ray.tfar[i] = -std::numeric_limits<float>::infinity();
    }
    Query query(lanes.data(), packets);
    {
      const FloatingPointMode mode(FloatingPointMode::kFlushed);
      if (packets) query.intersect(scene, valid.data(), packet);
      for (unsigned i = 0; !packets && i < kLanes; ++i) {
        RTCRayHit one = ray_of(packet.ray, i);
        if (valid[i] != 0) query.intersect(scene, one);
      }
    }
    for (unsigned i = 0; i < rays.size(); ++i) {
      const Lane& lane = lanes[i];
      hits[i] = lane.triangle == kNone
                    ? Hit{}
                    : Hit{std::min(lane.nearest * lane.length, rays[i].max_range), lane.triangle};
    }
  }
};

Surface::Surface(const TriangleMesh& mesh) {
  check(mesh);
  scene_ = std::make_unique<Scene>(mesh);
  scene_->build();
}
Surface::~Surface() = default;
Surface::Surface(Surface&&) noexcept = default;
Surface& Surface::operator=(Surface&&) noexcept = default;

void Surface::cast(std::span<const Ray> rays, std::span<Hit> hits) const {
  if (rays.size() != hits.size())
    throw std::invalid_argument("surface: " + std::to_string(rays.size()) + " rays, but room for " +
                                std::to_string(hits.size()) + " hits");
  for (std::size_t i = 0; i < rays.size(); ++i) check_ray(rays[i], i);
  const auto piece = [&](std::size_t begin, std::size_t end) {
    const FloatingPointMode mode(FloatingPointMode::kToNearest);
    for (std::size_t i = begin; i < end; i += kLanes) {
      const std::size_t count = std::min<std::size_t>(kLanes, end - i);
      scene_->first(rays.subspan(i, count), hits.subspan(i, count));
    }
  };
  constexpr std::size_t kChunk = 256;
  for_each_chunk(rays.size(), kChunk, piece);
}

}  // namespace frontlux::sim
