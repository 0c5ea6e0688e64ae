#include <frontlux/python/arrays.hpp>

#include <algorithm>

namespace frontlux::python {
namespace {

// An ndarray as it is, anything else as numpy makes an array of it.
py::array array_of(const char* name, const py::object& object) {
  if (py::isinstance<py::array>(object)) return py::reinterpret_borrow<py::array>(object);
  try {
    return py::module_::import("numpy").attr("asarray")(object);
  } catch (py::error_already_set& error) {
    if (!error.matches(PyExc_TypeError) && !error.matches(PyExc_ValueError)) throw;
    throw py::type_error(std::string(name) + ": no array: " + error.what());
  }
}

// Other than ndarrays as float64: what numpy itself would make a number of, as text and None, is none.
py::array numbers_of(const char* name, const py::object& object) {
  py::array array = array_of(name, object);
  if (array.is(object)) return array;
  const char kind = array.dtype().kind();
  if (kind != 'i' && kind != 'u' && kind != 'f')
    throw py::type_error(std::string(name) + ": no array of numbers, but of dtype " +
                         py::str(array.dtype()).cast<std::string>());
  return array.attr("astype")(py::dtype::of<double>(), py::arg("order") = "C", py::arg("copy") = false);
}

py::array keys_of(const char* name, const py::object& object) {
  if (py::isinstance<py::array>(object)) return py::reinterpret_borrow<py::array>(object);
  return integers_of<std::uint16_t>(name, object);
}

[[noreturn]] void wrong_type(const char* name, const py::array& array, const char* expected) {
  throw py::type_error(std::string(name) + ": dtype " + py::str(array.dtype()).cast<std::string>() +
                       ", but has to be " + expected);
}

Shape shape_of(const py::array& array) { return {array.shape(), array.shape() + array.ndim()}; }

// The shape without the axis of the rows.
Shape without_rows(const char* name, const py::array& array, py::ssize_t width) {
  Shape shape = shape_of(array);
  if (width == 0) return shape;
  if (shape.empty() || shape.back() != width)
    throw py::value_error(std::string(name) + ": shape " + text_of(shape) + ", but has to be (..., " +
                          std::to_string(width) + ")");
  shape.pop_back();
  return shape;
}

}  // namespace

std::string text_of(const Shape& shape) {
  std::string text = "(";
  for (const py::ssize_t length : shape) text += (text == "(" ? "" : ", ") + std::to_string(length);
  return text + (shape.size() == 1 ? ",)" : ")");
}

std::size_t size_of(const Shape& shape) {
  std::size_t size = 1;
  for (const py::ssize_t length : shape) size *= static_cast<std::size_t>(length);
  return size;
}

Shape with(Shape shape, py::ssize_t last) {
  shape.push_back(last);
  return shape;
}

namespace detail {

py::array integers_of(const char* name, const py::object& object, const py::dtype& dtype, double greatest) {
  const py::array numbers = array_of(name, object);
  const char kind = numbers.dtype().kind();
  if (numbers.size() != 0) {
    if (kind != 'i' && kind != 'u')
      throw py::type_error(std::string(name) + ": dtype " + py::str(numbers.dtype()).cast<std::string>() +
                           ", but has to be of integers");
    const py::object least = numbers.attr("min")(), most = numbers.attr("max")();
    if (least.cast<double>() < 0 || most.cast<double>() > greatest)
      throw py::value_error(std::string(name) + ": numbers from " + py::str(least).cast<std::string>() +
                            " to " + py::str(most).cast<std::string>() + ", but they have to be from 0 to " +
                            std::to_string(static_cast<std::uint64_t>(greatest)));
  }
  return numbers.attr("astype")(dtype, py::arg("order") = "C");
}

}  // namespace detail

void check_memory(const char* name, const py::array& array) {
  constexpr int kNeeded =
      py::detail::npy_api::NPY_ARRAY_C_CONTIGUOUS_ | py::detail::npy_api::NPY_ARRAY_ALIGNED_;
  if ((array.flags() & kNeeded) != kNeeded)
    throw py::value_error(
        std::string(name) +
        ": not contiguous or not aligned in memory; make it with numpy.require(..., requirements='CA')");
}

Numbers::Numbers(const char* name, const py::object& object, py::ssize_t width)
    : name_(name), array_(numbers_of(name, object)) {
  if (py::isinstance<py::array_t<float>>(array_))
    floats_ = static_cast<const float*>(array_.data());
  else if (py::isinstance<py::array_t<double>>(array_))
    doubles_ = static_cast<const double*>(array_.data());
  else
    wrong_type(name, array_, "float32 or float64");
  shape_ = without_rows(name, array_, width);
  check_memory(name, array_);
  if (!shape_.empty()) step_ = static_cast<std::size_t>(std::max<py::ssize_t>(width, 1));
}

Shape common_shape(std::initializer_list<const Numbers*> arguments) {
  const Numbers* first = nullptr;
  for (const Numbers* argument : arguments) {
    if (argument->shape().empty()) continue;
    if (first == nullptr) first = argument;
    if (argument->shape() != first->shape())
      throw py::value_error(std::string(argument->name()) + " and " + first->name() + ": for shapes " +
                            text_of(argument->shape()) + " and " + text_of(first->shape()) +
                            " (without the last axis of points), which have to be equal, or of one of them");
  }
  return first == nullptr ? Shape{} : first->shape();
}

Eigen::Isometry3d pose_of(const Numbers& numbers) {
  constexpr double kRounding = 1e-4;
  const Eigen::Isometry3d T_map_sensor(matrix_of<4>(numbers));
  const Eigen::Matrix3d turn = T_map_sensor.linear();
  const Eigen::RowVector4d last = T_map_sensor.matrix().row(3) - Eigen::RowVector4d::Unit(3);
  if (!T_map_sensor.matrix().allFinite() || !(turn * turn.transpose()).isIdentity(kRounding) ||
      turn.determinant() < 0.0 || !last.isZero(kRounding))
    throw py::value_error(std::string(numbers.name()) +
                          ": its upper left (3, 3) has to be a rotation, and its last row (0, 0, 0, 1)");
  return T_map_sensor;
}

bool are_keys(const py::object& object) { return py::isinstance<py::array_t<std::uint16_t>>(object); }

Keys::Keys(const char* name, const py::object& object) : name_(name), array_(keys_of(name, object)) {
  static_assert(sizeof(VoxelKey) == 3 * sizeof(std::uint16_t));
  if (!py::isinstance<py::array_t<std::uint16_t>>(array_)) wrong_type(name, array_, "uint16: voxel keys");
  shape_ = without_rows(name, array_, 3);
  check_memory(name, array_);
  keys_ = {static_cast<const VoxelKey*>(array_.data()), size_of(shape_)};
}

VoxelKey Keys::one() const {
  if (!shape_.empty()) throw py::value_error(std::string(name_) + ": has to be one key, of shape (3,)");
  return keys_[0];
}

py::array_t<std::uint16_t> to_array(std::span<const VoxelKey> keys) {
  py::array_t<std::uint16_t> array(Shape{static_cast<py::ssize_t>(keys.size()), 3});
  std::copy(keys.begin(), keys.end(), reinterpret_cast<VoxelKey*>(array.mutable_data()));
  return array;
}

Outputs::Outputs(Shape shape, const std::optional<py::dict>& given)
    : shape_(std::move(shape)), given_(given.has_value()), arrays_(given ? *given : py::dict()) {}

void* Outputs::memory(const char* name, py::ssize_t width, const py::dtype& dtype) {
  const Shape shape = width == 0 ? shape_ : with(shape_, width);
  if (!given_) arrays_[name] = py::array(dtype, shape);
  if (!arrays_.contains(name)) return nullptr;
  const std::string label = std::string("out[\"") + name + "\"]";
  const py::object object = arrays_[name];
  if (!py::isinstance<py::array>(object)) throw py::type_error(label + ": no numpy array");
  auto array = py::reinterpret_borrow<py::array>(object);
  if (!array.dtype().equal(dtype))
    wrong_type(label.c_str(), array, std::string(py::str(py::handle(dtype))).c_str());
  if (shape_of(array) != shape)
    throw py::value_error(label + ": shape " + text_of(shape_of(array)) + ", but has to be " +
                          text_of(shape));
  check_memory(label.c_str(), array);
  if (!array.writeable()) throw py::value_error(label + ": read-only");
  used_.push_back(array);
  return array.mutable_data();
}

py::dict Outputs::arrays() const {
  if (given_ && used_.size() != arrays_.size())
    throw py::value_error("out: one of its names is none of an answer's arrays");
  return arrays_;
}

UnknownPolicy policy_of(const std::string& unknown) {
  if (unknown == "block") return UnknownPolicy::kBlock;
  if (unknown == "pass") return UnknownPolicy::kPass;
  throw py::value_error("unknown: '" + unknown + "', but has to be 'block' or 'pass'");
}

}  // namespace frontlux::python
