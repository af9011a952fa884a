#include "python/hal/values.hpp"

#include <cinttypes>

#include "hal/stream.hpp"
#include "python/hal/errors.hpp"

namespace kerf::python {

using hal::Type;

namespace {

py::object new_reference(PyObject* object) {
  if (object == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::object>(object);
}

[[noreturn]] void out_of_range(py::handle number) {
  raise(PyExc_OverflowError, "Value " + std::string(py::str(number)) + " out of range");
}

double float_from(py::handle value) {
  PyObject* number = PyNumber_Float(value.ptr());
  if (number == nullptr) {
    if (PyErr_ExceptionMatches(PyExc_TypeError) != 0 ||
        PyErr_ExceptionMatches(PyExc_ValueError) != 0) {
      PyErr_Clear();
      raise(PyExc_TypeError, std::string("Number expected, not ") + Py_TYPE(value.ptr())->tp_name);
    }
    throw py::error_already_set();
  }
  return PyFloat_AsDouble(new_reference(number).ptr());
}

std::int64_t signed_from(py::handle value, std::int64_t least, std::int64_t most) {
  const py::object number = new_reference(PyNumber_Long(value.ptr()));
  const long long n = PyLong_AsLongLong(number.ptr());
  if (n == -1 && PyErr_Occurred() != nullptr) throw py::error_already_set();
  if (n < least || n > most) out_of_range(number);
  return n;
}

std::uint64_t unsigned_64_from(py::handle value) {
  const py::object number = new_reference(PyNumber_Long(value.ptr()));
  const py::object zero = py::int_(0);
  if (number < zero) out_of_range(number);
  const unsigned long long n = PyLong_AsUnsignedLongLong(number.ptr());
  if (PyErr_Occurred() != nullptr) throw py::error_already_set();
  return n;
}

bool bool_from(py::handle value) {
  const int truth = PyObject_IsTrue(value.ptr());
  if (truth < 0) throw py::error_already_set();
  return truth != 0;
}

}  // namespace

py::object to_python(Type type, std::uint64_t raw, const rtapi::Segment& segment) {
  raw = hal::stream_value(type, raw);
  switch (type) {
    case Type::bit: return py::bool_(raw != 0);
    case Type::floating: return py::float_(hal::from_raw<double>(raw));
    case Type::s32:
    case Type::s64: return py::int_(hal::from_raw<std::int64_t>(raw));
    case Type::port: return py::int_(port_at(raw, segment).size());
    default: return py::int_(raw);
  }
}

hal::Port port_at(std::uint64_t raw, const rtapi::Segment& segment) {
  const auto handle = static_cast<std::uint32_t>(raw);
  if (handle == 0 || handle % alignof(hal::PortHeader) != 0 ||
      !segment.in_use(handle, sizeof(hal::PortHeader))) {
    return {};
  }
  hal::Port port(segment.base(), handle);
  return segment.in_use(handle, hal::Port::bytes(port.size())) ? port : hal::Port();
}

std::uint64_t from_python(Type type, py::handle value) {
  switch (type) {
    case Type::bit: return hal::to_raw(bool_from(value));
    case Type::floating: return hal::to_raw(float_from(value));
    case Type::s32: return hal::to_raw(signed_from(value, INT32_MIN, INT32_MAX));
    case Type::u32: return hal::to_raw(signed_from(value, 0, UINT32_MAX));
    case Type::s64: return hal::to_raw(signed_from(value, INT64_MIN, INT64_MAX));
    case Type::u64: return unsigned_64_from(value);
    default: raise(PyExc_TypeError, "a port has no value: use read(), write() and their like");
  }
}

std::string value_words(py::handle value) {
  if (PyBool_Check(value.ptr())) return value.ptr() == Py_True ? "1" : "0";
  return std::string(py::str(value));
}

Type type_from_number(int number) {
  return number >= static_cast<int>(Type::bit) && number <= static_cast<int>(Type::u64)
             ? static_cast<Type>(number)
             : Type::unspecified;
}

const char* type_label(Type type) {
  switch (type) {
    case Type::bit: return "BIT";
    case Type::floating: return "FLOAT";
    case Type::s32: return "S32";
    case Type::u32: return "U32";
    case Type::s64: return "S64";
    case Type::u64: return "U64";
    case Type::port: return "PORT";
    default: return "UNKNOWN";
  }
}

const char* dir_label(hal::Dir dir) {
  switch (dir) {
    case hal::Dir::in: return "IN";
    case hal::Dir::out: return "OUT";
    case hal::Dir::io: return "IO";
    case hal::Dir::ro: return "RO";
    case hal::Dir::rw: return "RW";
    default: return "UNKNOWN";
  }
}

}  // namespace kerf::python
