#pragma once

#include <frontlux/ray.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace frontlux::python {

namespace py = pybind11;

/// The lengths of an array's axes.
using Shape = std::vector<py::ssize_t>;

/// "(480, 640, 3)"
[[nodiscard]] std::string text_of(const Shape& shape);
[[nodiscard]] std::size_t size_of(const Shape& shape);
/// With one more axis.
[[nodiscard]] Shape with(Shape shape, py::ssize_t last);

/// An argument of float32 or float64, read where numpy holds it: numbers, or rows of some numbers along the
/// last axis. Sequences of numbers are copied. One number or row stands for as many as there are others.
class Numbers {
 public:
  /// @param width  numbers in a row; 0: no rows
  /// @throws py::type_error for another dtype, py::value_error for another last axis, or an array that is not
  ///         contiguous; both name the argument
  Numbers(const char* name, const py::object& object, py::ssize_t width);

  [[nodiscard]] const char* name() const { return name_; }
  /// Without the axis of the rows.
  [[nodiscard]] const Shape& shape() const { return shape_; }

  /// A number, or one of a row.
  [[nodiscard]] double number(std::size_t i, std::size_t column = 0) const {
    const std::size_t at = i * step_ + column;
    return doubles_ != nullptr ? doubles_[at] : static_cast<double>(floats_[at]);
  }
  [[nodiscard]] bool are_floats() const { return floats_ != nullptr; }
  /// A row of three. @pre are_floats()
  [[nodiscard]] Eigen::Vector3f float_point(std::size_t i) const {
    return Eigen::Map<const Eigen::Vector3f>(floats_ + i * step_);
  }
  /// A row of three.
  [[nodiscard]] Eigen::Vector3f point(std::size_t i) const {
    if (doubles_ != nullptr) return Eigen::Map<const Eigen::Vector3d>(doubles_ + i * step_).cast<float>();
    return float_point(i);
  }

 private:
  const char* name_;
  py::array array_;
  Shape shape_;
  const float* floats_ = nullptr;
  const double* doubles_ = nullptr;
  std::size_t step_ = 0;  // from one number or row to the next
};

/// The shape of the answers. @throws py::value_error naming two arguments whose shapes differ
[[nodiscard]] Shape common_shape(std::initializer_list<const Numbers*> arguments);

/// A matrix of n x n numbers. @pre the shape is {n}
template <int n>
[[nodiscard]] Eigen::Matrix<double, n, n> matrix_of(const Numbers& numbers) {
  Eigen::Matrix<double, n, n> matrix;
  for (Eigen::Index row = 0; row < n; ++row)
    for (Eigen::Index column = 0; column < n; ++column)
      matrix(row, column) = numbers.number(static_cast<std::size_t>(row), static_cast<std::size_t>(column));
  return matrix;
}

/// What maps the sensor's frame into the map's.
/// @throws py::value_error naming the argument unless it is a rotation, a translation and (0, 0, 0, 1)
/// @pre the shape is {4}
[[nodiscard]] Eigen::Isometry3d pose_of(const Numbers& numbers);

namespace detail {
[[nodiscard]] py::array integers_of(const char* name, const py::object& object, const py::dtype& dtype,
                                    double greatest);
}

/// A contiguous copy of an array or a sequence of integers, which numpy itself would wrap to fit.
/// @throws py::type_error unless they are integers, py::value_error unless they fit; both name the argument
template <class Integer>
[[nodiscard]] py::array_t<Integer> integers_of(const char* name, const py::object& object) {
  return detail::integers_of(name, object, py::dtype::of<Integer>(),
                             static_cast<double>(std::numeric_limits<Integer>::max()));
}

/// Whether an argument is an array of voxel keys and not of points.
[[nodiscard]] bool are_keys(const py::object& object);

/// Voxel keys, uint16 of shape (..., 3), read where numpy holds them.
class Keys {
 public:
  /// @throws as `Numbers` does
  Keys(const char* name, const py::object& object);
  [[nodiscard]] const Shape& shape() const { return shape_; }
  [[nodiscard]] std::span<const VoxelKey> span() const { return keys_; }
  /// @throws py::value_error unless there is one
  [[nodiscard]] VoxelKey one() const;

 private:
  const char* name_;
  py::array array_;
  Shape shape_;
  std::span<const VoxelKey> keys_;
};
[[nodiscard]] py::array_t<std::uint16_t> to_array(std::span<const VoxelKey> keys);

/// What an array has to be for us to use its memory as it is: contiguous, aligned, of the machine's byte
/// order.
/// @throws as `Numbers` does
void check_memory(const char* name, const py::array& array);

/// Arrays by name that answers are written to: new ones, or those that the caller gave. They last as long as
/// this.
class Outputs {
 public:
  /// @param given  only these are written
  Outputs(Shape shape, const std::optional<py::dict>& given);

  /// The memory of one, of the answers' shape and perhaps one more axis; null if it is not wanted.
  /// @throws py::type_error, py::value_error naming it, if an array that was given does not fit or is
  /// read-only
  template <class T>
  [[nodiscard]] T* memory(const char* name, py::ssize_t width = 0) {
    return static_cast<T*>(memory(name, width, py::dtype::of<T>()));
  }

  /// @throws py::value_error naming an array that was given and never asked for
  [[nodiscard]] py::dict arrays() const;

 private:
  void* memory(const char* name, py::ssize_t width, const py::dtype& dtype);

  Shape shape_;
  bool given_;
  py::dict arrays_;
  std::vector<py::array> used_;  // so that they last, whatever becomes of the dict that was given
};

/// @throws py::value_error unless it is "block" or "pass"
[[nodiscard]] UnknownPolicy policy_of(const std::string& unknown);

}  // namespace frontlux::python
