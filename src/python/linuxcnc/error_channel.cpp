// linuxcnc.error_channel: operator messages, each once for every channel.
#include <deque>

#include "python/linuxcnc/module.hpp"
#include "task/api/message_reader.hpp"

namespace kerf::python {
namespace {

class ErrorChannel {
 public:
  ErrorChannel() { (void)attach(); }

  py::object poll() {
    if (queue_.empty()) read();
    if (queue_.empty()) return py::none();
    const Message message = std::move(queue_.front());
    queue_.pop_front();
    return py::make_tuple(message.kind, message.text);
  }

 private:
  struct Message {
    int kind{0};
    std::string text;
  };

  /// Messages from here on are seen.
  rtapi::Status attach() {
    KERF_CHECK(live_.poll());
    log_ = &live_.view()->task_shared();
    cursor_ = log_->messages.newest.observe();
    return {};
  }

  void read() {
    const task::TaskShared* before = log_;
    if (auto polled = live_.poll(); !polled.ok()) {
      log_ = nullptr;
      throw_error("Error buffer invalid: " + polled.error().message());
    }
    if (&live_.view()->task_shared() != before || before == nullptr) {
      log_ = &live_.view()->task_shared();
      cursor_ = 0;  // a machine that started since: all that it said
    }
    std::uint64_t lost = 0;
    for (const task::OperatorMessage& m : task::read_messages(log_->messages, cursor_, &lost))
      queue_.push_back({static_cast<int>(m.kind), std::string(m.text.view())});
    if (lost > 0)
      queue_.push_front({11, std::to_string(lost) +
                                 " messages were lost: this error channel was not polled in time"});
  }

  LiveView live_;
  const task::TaskShared* log_{nullptr};
  std::uint64_t cursor_{0};
  std::deque<Message> queue_;
};

}  // namespace

void add_error_channel(py::module_& m) {
  py::class_<ErrorChannel> c(m, "error_channel",
                             "Messages for the operator since this object was made.");
  c.attr("__module__") = "linuxcnc";
  c.def(py::init([](const py::args&) {
     return std::make_unique<ErrorChannel>();
   })).def("poll", &ErrorChannel::poll, "(kind, text) of the next message, or None.");
}

}  // namespace kerf::python
