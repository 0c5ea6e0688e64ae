#include "bindings.hpp"

#include <frontlux/parallel.hpp>
#include <frontlux/python/arrays.hpp>

#include <pybind11/stl.h>

#include <algorithm>

namespace frontlux::python {
namespace {

using Self = std::shared_ptr<Caster>;

// Memory of a thread for some queries or answers, kept for the next. Two tasks of one thread may need theirs
// at the same time: the caster is parallel itself, and a thread that waits in it may begin another part.
template <class T>
class Buffer {
 public:
  static constexpr std::size_t kSize = 1 << 12;
  Buffer() {
    if (idle().empty()) {
      values_.resize(kSize);
      return;
    }
    values_ = std::move(idle().back());
    idle().pop_back();
  }
  ~Buffer() {
    try {
      idle().push_back(std::move(values_));
    } catch (const std::bad_alloc&) {  // it is made anew
    }
  }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;
  [[nodiscard]] std::span<T> first(std::size_t size) { return std::span(values_).first(size); }

 private:
  static std::vector<std::vector<T>>& idle() {
    thread_local std::vector<std::vector<T>> of_thread;
    return of_thread;
  }
  std::vector<T> values_;
};

// Answers queries a part at a time, so that what lies between numpy's arrays and the caster stays in the
// cache: queries[i] = make(i); ask(queries, begin), where begin is the number of the first. Python's signals,
// such as Ctrl-C, are looked at from time to time; what they raise ends it.
template <class Make, class Ask>
void ask_in_parts(std::size_t size, const Make& make, const Ask& ask) {
  using Query = decltype(make(std::size_t{0}));
  const auto ask_some = [&](std::size_t begin, std::size_t end) {
    Buffer<Query> buffer;
    const std::span<Query> queries = buffer.first(end - begin);
    for (std::size_t i = begin; i < end; ++i) queries[i - begin] = make(i);
    ask(std::span<const Query>(queries), begin);
  };
  constexpr std::size_t kBetweenSignals = std::size_t{1} << 20;
  for (std::size_t first = 0; first < size; first += kBetweenSignals) {
    if (first > 0 && PyErr_CheckSignals() != 0) throw py::error_already_set();
    const OthersRun others_run;
    for_each_chunk(std::min(kBetweenSignals, size - first), Buffer<Query>::kSize,
                   [&](std::size_t begin, std::size_t end) { ask_some(first + begin, first + end); });
  }
}

// The memory of an array of answers' fields, if it is wanted; enumerations are of 8 bits, keys and points
// rows of three.
template <class Field, class Number>
Field* fields(Outputs& outputs, const char* name) {
  constexpr py::ssize_t kWidth = sizeof(Field) / sizeof(Number);
  return reinterpret_cast<Field*>(outputs.memory<Number>(name, kWidth == 1 ? 0 : kWidth));
}

// Writes one field of all answers to an array from a place on, if it is wanted.
template <class Answer, class Field>
void store(std::span<Answer> answers, Field Answer::*field, Field* array, std::size_t begin) {
  if (array == nullptr) return;
  for (std::size_t i = 0; i < answers.size(); ++i) array[begin + i] = answers[i].*field;
}

class Rays {
 public:
  Rays(const py::object& origins, const py::object& directions, const py::object& max_range)
      : origins_("origins", origins, 3),
        directions_("directions", directions, 3),
        ranges_("max_range", max_range, 0),
        shape_(common_shape({&origins_, &directions_, &ranges_})) {}
  [[nodiscard]] const Shape& shape() const { return shape_; }
  // Calls use(make), where make(i) is a ray. Rays of floats, the usual ones, are made without asking of each
  // what its numbers are: that is a fiftieth of a cast.
  template <class Use>
  void for_maker(const Use& use) const {
    if (origins_.are_floats() && directions_.are_floats())
      use([this](std::size_t i) {
        return Ray{origins_.float_point(i), directions_.float_point(i), ranges_.number(i)};
      });
    else
      use([this](std::size_t i) { return Ray{origins_.point(i), directions_.point(i), ranges_.number(i)}; });
  }

 private:
  Numbers origins_, directions_, ranges_;
  Shape shape_;
};

// Calls use(shape, make_segment) for segments between points or between keys.
template <class Use>
void for_segments(const py::object& from, const py::object& to, const Use& use) {
  if (!are_keys(from) && !are_keys(to)) {
    const Numbers begins("from_points", from, 3), ends("to_points", to, 3);
    use(common_shape({&begins, &ends}), [&](std::size_t i) {
      return Segment{begins.point(i), ends.point(i)};
    });
    return;
  }
  const Keys begins("from_points", from), ends("to_points", to);
  const bool one_begin = begins.shape().empty(), one_end = ends.shape().empty();
  if (!one_begin && !one_end && begins.shape() != ends.shape())
    throw py::value_error("from_points and to_points: keys of shapes " + text_of(with(begins.shape(), 3)) +
                          " and " + text_of(with(ends.shape(), 3)) +
                          ", which have to be equal, or (3,) for one of them");
  use(one_begin ? ends.shape() : begins.shape(), [&](std::size_t i) {
    return KeySegment{begins.span()[one_begin ? 0 : i], ends.span()[one_end ? 0 : i]};
  });
}

py::dict cast(const Self& self, const py::object& origins, const py::object& directions,
              const py::object& max_range, const std::string& unknown, const std::optional<py::dict>& out) {
  const Rays rays(origins, directions, max_range);
  const UnknownPolicy policy = policy_of(unknown);
  Outputs outputs(rays.shape(), out);
  auto* stop = fields<RayStop, std::uint8_t>(outputs, "stop");
  auto* state = fields<Occupancy, std::uint8_t>(outputs, "state");
  auto* key = fields<VoxelKey, std::uint16_t>(outputs, "key");
  auto* end = fields<Eigen::Vector3f, float>(outputs, "end");
  auto* entry = fields<Eigen::Vector3f, float>(outputs, "entry");
  auto* distance = fields<float, float>(outputs, "distance");
  py::dict arrays = outputs.arrays();
  rays.for_maker([&](const auto& make) {
    ask_in_parts(size_of(rays.shape()), make, [&](std::span<const Ray> some, std::size_t begin) {
      Buffer<Hit> buffer;
      const std::span<Hit> hits = buffer.first(some.size());
      self->answers->cast(some, hits, policy);
      store(hits, &Hit::stop, stop, begin);
      store(hits, &Hit::state, state, begin);
      store(hits, &Hit::key, key, begin);
      store(hits, &Hit::end, end, begin);
      store(hits, &Hit::entry, entry, begin);
      store(hits, &Hit::distance, distance, begin);
    });
  });
  return arrays;
}

// What `count` and `count_between` return: `ask` fills counts for some of the queries that `make` makes.
template <class Make>
py::dict counts_of(const Self& self, const Shape& shape, const Make& make, const std::string& unknown,
                   const std::optional<py::dict>& out) {
  const UnknownPolicy policy = policy_of(unknown);
  Outputs outputs(shape, out);
  auto* unknown_voxels = fields<std::uint32_t, std::uint32_t>(outputs, "unknown");
  auto* free_voxels = fields<std::uint32_t, std::uint32_t>(outputs, "free");
  auto* occupied_voxels = fields<std::uint32_t, std::uint32_t>(outputs, "occupied");
  auto* stop = fields<RayStop, std::uint8_t>(outputs, "stop");
  py::dict arrays = outputs.arrays();
  ask_in_parts(size_of(shape), make, [&](const auto& some, std::size_t begin) {
    Buffer<PathCount> buffer;
    const std::span<PathCount> counts = buffer.first(some.size());
    self->answers->count(some, counts, policy);
    store(counts, &PathCount::unknown, unknown_voxels, begin);
    store(counts, &PathCount::free, free_voxels, begin);
    store(counts, &PathCount::occupied, occupied_voxels, begin);
    store(counts, &PathCount::stop, stop, begin);
  });
  return arrays;
}

py::dict count(const Self& self, const py::object& origins, const py::object& directions,
               const py::object& max_range, const std::string& unknown, const std::optional<py::dict>& out) {
  const Rays rays(origins, directions, max_range);
  py::dict counts;
  rays.for_maker([&](const auto& make) { counts = counts_of(self, rays.shape(), make, unknown, out); });
  return counts;
}

py::dict count_between(const Self& self, const py::object& from, const py::object& to,
                       const std::string& unknown, const std::optional<py::dict>& out) {
  py::dict counts;
  for_segments(from, to, [&](const Shape& shape, const auto& make) {
    counts = counts_of(self, shape, make, unknown, out);
  });
  return counts;
}

py::array_t<bool> visible(const Self& self, const py::object& from, const py::object& to,
                          const std::string& unknown) {
  const UnknownPolicy policy = policy_of(unknown);
  py::array_t<bool> result;
  for_segments(from, to, [&](const Shape& shape, const auto& make) {
    result = py::array_t<bool>(shape);
    auto* data = reinterpret_cast<std::uint8_t*>(result.mutable_data());
    ask_in_parts(size_of(shape), make, [&](const auto& some, std::size_t begin) {
      self->answers->visible(some, std::span(data + begin, some.size()), policy);
    });
  });
  return result;
}

VoxelGrid snapshot_of(const Held<VoxelGrid>& grid) {
  return grid->use([](const VoxelGrid& now) { return now; });
}

Self make(const Held<VoxelGrid>& held, const std::string& kind) {
  const VoxelGrid grid = snapshot_of(held);
  const OthersRun others_run;
  std::shared_ptr<RayCaster> caster;
  if (kind == "fast")
    caster = make_ray_caster(grid);
  else if (kind == "embree")
    caster = make_embree_ray_caster(grid);
  else if (kind == "grid")
    caster = make_grid_ray_caster(grid);
  else
    throw py::value_error("kind: '" + kind + "', but has to be 'fast', 'embree' or 'grid'");
  return Self(new Caster{caster, caster});
}

void update(const Self& self, const Held<VoxelGrid>& held) {
  if (self->own == nullptr)
    throw py::value_error("this caster belongs to a LiveMap, which keeps it up to date");
  const VoxelGrid grid = snapshot_of(held);
  const OthersRun others_run;
  const std::lock_guard lock(self->updating);
  self->own->update(grid);
}

}  // namespace

void bind_ray_caster(py::module_& module) {
  py::class_<Caster, Self>(
      module, "RayCaster",
      R"(Answers ray queries on a snapshot of a map, bit for bit as OctoMap's castRay would.

Points and directions are float32 or float64 arrays of shape (..., 3), contiguous, in the frame of the map, in metres.
float32 is what the answers are computed with; float64 is rounded to it. One point of shape (3,) stands for as many as
there are others; so does one range. Results have the shape (...) of the arguments, or (..., 3) for points and keys.

Voxels of which nothing is known stop a ray with unknown='block' (castRay's ignoreUnknownCells=False) and let it pass
with unknown='pass'. Rays that cannot be cast (not finite, outside the key range, without direction) are answered with
RayStop.INVALID. Work is spread over all cores. Queries may run in several threads, also while another one updates.)")
      .def(
          py::init(&make), py::arg("grid"), py::arg("kind") = "fast",
          "A caster of the grid as it is now. kind: 'fast'; 'embree': the BVH, without tables; 'grid': costs "
          "nothing to build.")
      .def("cast", &cast, py::arg("origins"), py::arg("directions"), py::arg("max_range") = -1.0,
           py::arg("unknown") = "block", py::arg("out") = py::none(),
           R"(Where each ray ends.

origins, directions: (..., 3) or (3,); directions of any length. max_range: [m] number or (...), <= 0 or NaN: no limit; it
limits the distance from origin to the centres of voxels.

Returns a dict of arrays:
  stop      uint8 (...)       why it ended, a RayStop; OCCUPIED is castRay's True
  state     uint8 (...)       of the voxel in which it ended: UNKNOWN, FREE or OCCUPIED
  key       uint16 (..., 3)   of that voxel
  end       float32 (..., 3)  [m] the centre of that voxel: castRay's end point
  entry     float32 (..., 3)  [m] where the ray enters that voxel
  distance  float32 (...)     [m] from the origin to there

out: a dict with some of these names and arrays to write to; nothing else is computed or allocated.)")
      .def(
          "visible", &visible, py::arg("from_points"), py::arg("to_points"), py::arg("unknown") = "block",
          R"(bool (...): whether the line from one point reaches the voxel of the other, and nothing between blocks it.

from_points, to_points: (..., 3) or (3,), of the same kind: points [m], float32 or float64; or keys, uint16, whose centres
are then joined in exact integers. Lists of numbers are points, unless the other argument is an array of keys.)")
      .def("count", &count, py::arg("origins"), py::arg("directions"), py::arg("max_range") = -1.0,
           py::arg("unknown") = "block", py::arg("out") = py::none(),
           R"(How many voxels each ray crosses before it stops, from the voxel of its origin on.

Arguments as those of `cast`. Returns a dict of `unknown`, `free` and `occupied`, uint32 (...), and `stop`, uint8 (...).)")
      .def("count_between", &count_between, py::arg("from_points"), py::arg("to_points"),
           py::arg("unknown") = "block", py::arg("out") = py::none(),
           "The same from the voxel of one point, included, to that of another, excluded. Arguments as those "
           "of `visible`.")
      .def("update", &update, py::arg("grid"),
           "Answers from this grid from now on, which costs about what was changed in it. The resolution has "
           "to be the same.")
      .def_property_readonly(
          "grid",
          [](const Self& self) {
            return std::make_shared<Guarded<VoxelGrid>>(self->answers->grid().value());
          },
          "A snapshot of the map from which it answers.")
      .def_property_readonly(
          "memory_bytes",
          [](const Self& self) {
            const OthersRun others_run;
            return self->answers->memory_bytes();
          },
          "Bytes that it holds beside the grid's own.");
}

}  // namespace frontlux::python
