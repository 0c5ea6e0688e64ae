#include "box_scene.hpp"

#include "box_kernel.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <xmmintrin.h>

namespace frontlux::detail {
namespace {

// Embree wants denormals flushed to zero while it works. The caller's mode comes back afterwards: castRay's
// arithmetic needs it, and it is not ours to change.
class FlushDenormals {
 public:
  FlushDenormals() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | kFlushToZero | kDenormalsAreZero); }
  ~FlushDenormals() { _mm_setcsr(saved_); }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  static constexpr unsigned kFlushToZero = 0x8000, kDenormalsAreZero = 0x0040;
  unsigned saved_;
};

struct QueryContext {
  RTCIntersectContext embree;  // first: callbacks get a pointer to it
  std::uint8_t* too_close = nullptr;
};

}  // namespace

struct BoxScene::Embree {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::atomic<std::ptrdiff_t> bytes{0};
  std::vector<LocalBox> boxes;
  float tolerance = 0.0F;

  explicit Embree(std::vector<LocalBox> local_boxes, float error_bound)
      : boxes(std::move(local_boxes)), tolerance(error_bound) {
    device = rtcNewDevice(nullptr);
    if (device == nullptr) throw std::runtime_error("Embree cannot make a device on this machine");
    rtcSetDeviceMemoryMonitorFunction(
        device,
        [](void* counter, ssize_t bytes_more, bool) {
          static_cast<std::atomic<std::ptrdiff_t>*>(counter)->fetch_add(bytes_more,
                                                                        std::memory_order_relaxed);
          return true;
        },
        &bytes);
    scene = rtcNewScene(device);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(boxes.size()));
    rtcSetGeometryUserData(geometry, this);
    rtcSetGeometryBoundsFunction(geometry, &bounds_callback, nullptr);
    rtcSetGeometryOccludedFunction(geometry, &occluded_callback);
    rtcSetGeometryIntersectFunction(geometry, &intersect_callback);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    const RTCError error = rtcGetDeviceError(device);
    if (error != RTC_ERROR_NONE) {
      release();
      throw std::runtime_error("Embree cannot build a scene of " + std::to_string(boxes.size()) +
                               " boxes (error " + std::to_string(error) + ")");
    }
  }
  ~Embree() { release(); }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;

  void release() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }

  static void bounds_callback(const RTCBoundsFunctionArguments* args) {
    const auto* self = static_cast<const Embree*>(args->geometryUserPtr);
    const LocalBox& box = self->boxes[args->primID];
    // Padded beyond the tolerance, since the traversal rounds too: what the box test would call too close
    // must be reached.
    const float pad = 2.0F * self->tolerance;
    RTCBounds& bounds = *args->bounds_o;
    bounds.lower_x = box.center[0] - box.half[0] - pad;
    bounds.lower_y = box.center[1] - box.half[1] - pad;
    bounds.lower_z = box.center[2] - box.half[2] - pad;
    bounds.upper_x = box.center[0] + box.half[0] + pad;
    bounds.upper_y = box.center[1] + box.half[1] + pad;
    bounds.upper_z = box.center[2] + box.half[2] + pad;
  }

  static void occluded_callback(const RTCOccludedFunctionNArguments* args) {
    const auto* self = static_cast<const Embree*>(args->geometryUserPtr);
    auto* context = reinterpret_cast<QueryContext*>(args->context);
    box_kernel().occluded(self->boxes[args->primID], self->tolerance, args->valid,
                          reinterpret_cast<float*>(args->ray), args->N, context->too_close);
  }

  static void intersect_callback(const RTCIntersectFunctionNArguments* args) {
    const auto* self = static_cast<const Embree*>(args->geometryUserPtr);
    box_kernel().intersect(self->boxes[args->primID], self->tolerance, args->valid,
                           reinterpret_cast<float*>(args->rayhit), args->N, args->primID, args->geomID);
  }
};

BoxScene::BoxScene(std::vector<KeyBox> boxes) : boxes_(std::move(boxes)) {
  if (boxes_.empty()) return;
  std::array<int, 3> low{65536, 65536, 65536}, high{0, 0, 0};
  const auto grow = [](int& lower, int& upper, int min, int max) {
    lower = std::min(lower, min);
    upper = std::max(upper, max + 1);
  };
  for (const KeyBox& box : boxes_) {
    grow(low[0], high[0], box.min.x, box.max.x);
    grow(low[1], high[1], box.min.y, box.max.y);
    grow(low[2], high[2], box.min.z, box.max.z);
  }
  // In the middle of the boxes coordinates, and with them rounding errors, are smallest. All bounds are
  // integers.
  const auto middle = [&](std::size_t i) { return static_cast<std::uint16_t>((low[i] + high[i]) / 2); };
  origin_ = {middle(0), middle(1), middle(2)};
  double reach = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<int>(i);
    bounds_.min()[axis] = low[i] - middle(i);
    bounds_.max()[axis] = high[i] - middle(i);
    reach = std::max({reach, -bounds_.min()[axis], bounds_.max()[axis]});
  }
  // A coordinate of at most `reach` voxels is off by reach * 2^-24. The dozen operations between a probe and
  // its answer each add a few of those; 2^-19 leaves room for 32. The constant covers the double precision of
  // castRay's own path.
  tolerance_ = std::max(1e-4, std::ldexp(reach + 2.0, -19));

  std::vector<LocalBox> local;
  local.reserve(boxes_.size());
  for (const KeyBox& box : boxes_) {
    const auto half = [](int min, int max) { return static_cast<float>(max + 1 - min) * 0.5F; };
    const auto center = [](int min, int max, int origin) {
      return static_cast<float>(min + max + 1 - 2 * origin) * 0.5F;
    };
    local.push_back({{center(box.min.x, box.max.x, origin_.x), center(box.min.y, box.max.y, origin_.y),
                      center(box.min.z, box.max.z, origin_.z)},
                     {half(box.min.x, box.max.x), half(box.min.y, box.max.y), half(box.min.z, box.max.z)}});
  }
  embree_ = std::make_unique<Embree>(std::move(local), static_cast<float>(tolerance_));
}

BoxScene::~BoxScene() = default;

std::size_t BoxScene::memory_bytes() const {
  if (!embree_) return sizeof(*this);
  return sizeof(*this) + boxes_.capacity() * sizeof(KeyBox) + embree_->boxes.capacity() * sizeof(LocalBox) +
         static_cast<std::size_t>(embree_->bytes.load());
}

namespace {

void set_ray(RTCRay& ray, const Probe& probe, std::size_t id) {
  ray.org_x = probe.origin[0];
  ray.org_y = probe.origin[1];
  ray.org_z = probe.origin[2];
  ray.tnear = probe.t_near;
  ray.dir_x = probe.direction[0];
  ray.dir_y = probe.direction[1];
  ray.dir_z = probe.direction[2];
  ray.time = 0.0F;
  ray.tfar = probe.t_far;
  ray.mask = ~0U;
  ray.id = static_cast<unsigned>(id);
  ray.flags = 0;
}

}  // namespace

void BoxScene::occluded(std::span<const Probe> probes, std::span<Sight> sights) const {
  if (!embree_) {
    std::fill(sights.begin(), sights.end(), Sight::kClear);
    return;
  }
  std::array<RTCRay, kMaxBatch> rays;
  std::array<std::uint8_t, kMaxBatch> too_close{};
  const std::size_t size = probes.size();
  for (std::size_t i = 0; i < size; ++i) set_ray(rays[i], probes[i], i);
  QueryContext context;
  rtcInitIntersectContext(&context.embree);
  context.too_close = too_close.data();
  {
    const FlushDenormals scope;
    rtcOccluded1M(embree_->scene, &context.embree, rays.data(), static_cast<unsigned>(size), sizeof(RTCRay));
  }
  for (std::size_t i = 0; i < size; ++i) {
    const bool hit = rays[i].tfar == -std::numeric_limits<float>::infinity();
    sights[i] = hit ? Sight::kBlocked : too_close[i] != 0 ? Sight::kTooCloseToTell : Sight::kClear;
  }
}

void BoxScene::first(std::span<const Probe> probes, std::span<std::uint32_t> boxes) const {
  if (!embree_) {
    std::fill(boxes.begin(), boxes.end(), kNoBox);
    return;
  }
  std::array<RTCRayHit, kMaxBatch> rays;
  const std::size_t size = probes.size();
  for (std::size_t i = 0; i < size; ++i) {
    set_ray(rays[i].ray, probes[i], i);
    rays[i].hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rays[i].hit.primID = kNoBox;
    rays[i].hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  }
  QueryContext context;
  rtcInitIntersectContext(&context.embree);
  {
    const FlushDenormals scope;
    rtcIntersect1M(embree_->scene, &context.embree, rays.data(), static_cast<unsigned>(size),
                   sizeof(RTCRayHit));
  }
  for (std::size_t i = 0; i < size; ++i) boxes[i] = rays[i].hit.primID;
}

}  // namespace frontlux::detail
