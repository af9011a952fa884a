#include "hal/stream.hpp"

#include <cerrno>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>

#include "hal/client/find_stream.hpp"
#include "hal/shared_memory.hpp"
#include "python/hal/component.hpp"
#include "python/hal/errors.hpp"
#include "python/hal/stream.hpp"
#include "python/hal/values.hpp"

namespace kerf::python {

using hal::kStreamAbi;
using hal::kStreamColumns;

namespace {

std::string hex(std::uint32_t key) {
  char text[16];
  std::snprintf(text, sizeof text, "%" PRIx32, key);
  return text;
}

/// Named memory that is made with `make` and given back by drop(), unless its owner has exited.
std::byte* make_memory(const ComponentState& owner, const std::string& name, std::size_t bytes,
                       std::uint64_t abi) {
  auto offset = owner.link->ask({"shm-new", name, std::to_string(bytes), std::to_string(abi)});
  if (!offset.ok()) raise_os_error(offset.error());
  return owner.link->segment().at<std::byte>(std::strtoull(offset->c_str(), nullptr, 10));
}

void drop_memory(const ComponentState& owner, const std::string& name) {
  if (owner.link->usable()) (void)owner.link->ask({"shm-drop", name});
}

class PyStream {
 public:
  /// stream(component, key[, types]) or stream(component, key, depth, types).
  PyStream(const Component& component, std::uint32_t key, const py::args& rest)
      : owner_(component.state()), key_(key) {
    owner_->check();
    if (rest.size() > 2) {
      raise(PyExc_TypeError,
            "stream() takes a component, a key and types, or a component, a key, "
            "a depth and types");
    }
    if (rest.size() == 2) {
      create(py::cast<std::int64_t>(rest[0]), py::cast<std::string>(rest[1]));
    } else {
      attach(rest.size() == 1 ? py::cast<std::string>(rest[0]) : std::string());
    }
  }
  ~PyStream() {
    if (!creator_) return;
    stream_.close();
    drop_memory(*owner_, name());
  }
  PyStream(const PyStream&) = delete;
  PyStream& operator=(const PyStream&) = delete;

  void write(const py::tuple& row) {
    owner_->check();
    if (row.size() != stream_.columns()) {
      raise(PyExc_ValueError, std::string(row.size() < stream_.columns() ? "Too few" : "Too many") +
                                  " elements: the stream has " + std::to_string(stream_.columns()));
    }
    std::uint64_t values[kStreamColumns];
    for (std::size_t i = 0; i < row.size(); ++i) values[i] = from_python(stream_.type(i), row[i]);
    if (!stream_.write(values)) raise_os_error(ENOSPC);
  }

  py::object read() {
    owner_->check();
    std::uint64_t values[kStreamColumns];
    if (!stream_.read(values, &number_)) return py::none();
    py::tuple row(stream_.columns());
    for (std::size_t i = 0; i < row.size(); ++i) {
      row[i] = to_python(stream_.type(i), values[i], owner_->link->segment());
    }
    return row;
  }

  hal::Stream& stream() {
    owner_->check();
    return stream_;
  }
  [[nodiscard]] std::uint64_t number() const noexcept { return number_; }
  [[nodiscard]] std::string repr() const {
    return "<stream 0x" + hex(key_) + (creator_ ? " creator>" : ">");
  }

 private:
  [[nodiscard]] std::string name() const { return std::string(hal::stream_memory_name(key_)); }

  void create(std::int64_t depth, const std::string& types) {
    if (!hal::good_stream_types(types)) {
      say_error("stream: bad types '" + types + "': 1 to 21 letters of b f s u l k");
      raise_os_error(EINVAL);
    }
    if (depth < 1 || depth > std::int64_t{hal::kMaxStreamDepth}) {
      say_error("stream: depth must be 1 to 10000000");
      raise_os_error(EINVAL);
    }
    if (hal::find_stream(owner_->link->segment(), key_).ok()) {
      say_error("stream: there is one with the key 0x" + hex(key_) + " already");
      raise_os_error(EEXIST);
    }
    const auto rows = static_cast<std::uint32_t>(depth);
    std::byte* memory =
        make_memory(*owner_, name(), hal::Stream::bytes(rows, types.size()), kStreamAbi);
    stream_ = hal::Stream::create(memory, rows, types);
    creator_ = true;
  }

  void attach(const std::string& types) {
    auto found = hal::find_stream(owner_->link->segment(), key_, types);
    if (!found.ok()) raise_os_error(found.error());
    stream_ = *found;
  }

  std::shared_ptr<const ComponentState> owner_;
  std::uint32_t key_;
  hal::Stream stream_;
  bool creator_{false};
  std::uint64_t number_{0};  ///< of the row that was read last
};

/// Memory of plain bytes, made by whoever comes first.
class SharedMemory {
 public:
  SharedMemory(const Component& component, std::uint32_t key, std::size_t size)
      : owner_(component.state()), key_(key), size_(size), room_(size) {
    owner_->check();
    const auto found = owner_->link->view().find_memory(hal::shared_memory_name(key));
    if (found) room_ = found->bytes;
    if (size == 0 || size > room_) raise_os_error(EINVAL);
    data_ = make_memory(*owner_, hal::shared_memory_name(key), room_, hal::kSharedMemoryAbi);
  }
  ~SharedMemory() { drop_memory(*owner_, hal::shared_memory_name(key_)); }
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;

  py::object buffer() {
    owner_->check();
    return py::memoryview::from_memory(static_cast<void*>(data_), static_cast<py::ssize_t>(size_));
  }
  void set_size(std::size_t size) {
    owner_->check();
    if (size > room_) {
      raise(PyExc_ValueError, "the memory has " + std::to_string(room_) + " bytes");
    }
    size_ = size;
  }
  [[nodiscard]] std::string repr() const {
    char text[80];
    std::snprintf(text, sizeof text, "<shared memory buffer key=%08" PRIx32 " size=%zu>", key_,
                  size_);
    return text;
  }

 private:
  std::shared_ptr<const ComponentState> owner_;
  std::uint32_t key_;
  std::size_t size_;
  std::size_t room_;
  std::byte* data_{nullptr};
};

}  // namespace

void add_stream(py::module_& m) {
  py::class_<PyStream> stream(m, "stream",
                              "A FIFO of rows of values shared with another component.");
  stream.attr("__module__") = "hal";
  stream
      .def(py::init([](const Component& component, std::uint32_t key, const py::args& rest) {
        return std::make_unique<PyStream>(component, key, rest);
      }))
      .def("read", &PyStream::read, "The oldest row as a tuple, or None.")
      .def("write", &PyStream::write, py::arg("row"), "Appends a row; OSError when it is full.")
      .def_property_readonly("readable", [](PyStream& s) { return !s.stream().empty(); })
      .def_property_readonly("writable", [](PyStream& s) { return !s.stream().full(); })
      .def_property_readonly(
          "depth", [](PyStream& s) { return s.stream().size(); }, "Rows that wait to be read")
      .def_property_readonly(
          "maxdepth", [](PyStream& s) { return s.stream().depth(); }, "Rows that it has room for")
      .def_property_readonly("element_types",
                             [](PyStream& s) { return py::bytes(std::string(s.stream().types())); })
      .def_property_readonly("num_overruns", [](PyStream& s) { return s.stream().overruns(); })
      .def_property_readonly("num_underruns", [](PyStream& s) { return s.stream().underruns(); })
      .def_property_readonly("sampleno", &PyStream::number, "Number of the row read last")
      .def("__repr__", &PyStream::repr);
}

void add_shared_memory(py::module_& m) {
  py::class_<SharedMemory> memory(m, "shm", "Plain memory shared with another component.");
  memory.attr("__module__") = "hal";
  memory
      .def(py::init<const Component&, std::uint32_t, std::size_t>(), py::arg("component"),
           py::arg("key"), py::arg("size"))
      .def("getbuffer", &SharedMemory::buffer, "A memoryview of the bytes.")
      .def("setsize", &SharedMemory::set_size, py::arg("size"),
           "How many of the bytes getbuffer() shows.")
      .def("__repr__", &SharedMemory::repr);
}

}  // namespace kerf::python
