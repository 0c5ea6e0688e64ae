#pragma once

#include <frontlux/python/others_run.hpp>

#include <pybind11/pybind11.h>

#include <memory>
#include <mutex>
#include <utility>

namespace frontlux::python {

/// A value that Python's threads share: whoever uses it waits for the others, without Python's lock, so that
/// they can go on.
template <class T>
class Guarded {
 public:
  template <class... Arguments>
  explicit Guarded(Arguments&&... arguments) : value_(std::forward<Arguments>(arguments)...) {}

  /// What `use(value)` returns. It must not touch Python's objects.
  template <class Use>
  auto use(const Use& use) {
    const OthersRun others_run;
    const std::lock_guard lock(mutex_);
    return use(value_);
  }

 private:
  std::mutex mutex_;
  T value_;
};

/// How Python holds it. Methods take this, and not a reference: pybind11 refuses an object whose `__init__`
/// never ran for the former only.
template <class T>
using Held = std::shared_ptr<Guarded<T>>;

}  // namespace frontlux::python

namespace pybind11::detail {

/// Refuses None, which pybind11 would hand on as a null pointer.
template <class T>
class SomeObject : public copyable_holder_caster<T, std::shared_ptr<T>> {
 public:
  bool load(handle source, bool convert) {
    return !source.is_none() && copyable_holder_caster<T, std::shared_ptr<T>>::load(source, convert);
  }
};
template <class T>
class type_caster<std::shared_ptr<frontlux::python::Guarded<T>>>
    : public SomeObject<frontlux::python::Guarded<T>> {};

}  // namespace pybind11::detail
