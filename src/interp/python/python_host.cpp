#include "interp/python/python_host.hpp"

#include <pybind11/embed.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <condition_variable>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

#include "interp/python/modules.hpp"

namespace py = pybind11;

namespace kerf::interp {

namespace {

using namespace std::chrono_literals;

/// How often `stopped()` is asked while Python works, and how long a function may take to obey.
constexpr auto kAskEvery = 10ms;
constexpr auto kGrace = 300ms;

/// Raised in functions that are abandoned. Derives from BaseException: `except Exception` lets it pass.
PyObject* abandoned_error = nullptr;
/// The worker whose thread this is.
class Worker;
thread_local Worker* this_worker = nullptr;

std::string text_of(const py::error_already_set& e) {
  std::string line = e.what();
  return line.substr(0, line.find('\n'));
}

/// What the compiled module works on: set while the worker's interpreter waits.
ScriptSelf* self_in_use = nullptr;

ScriptSelf& self() {
  if (self_in_use == nullptr) throw std::runtime_error("there is no interpreter");
  return *self_in_use;
}

/// A message to the worker's thread.
struct Job {
  enum class Kind { work, answer, quit } kind{Kind::work};
  std::function<ScriptStep()> work;  ///< with the GIL held
  ScriptAnswer answer;
};

/// One thread that runs Python. Shared with the thread itself, so that a thread that never ends keeps what it uses.
class Worker : public std::enable_shared_from_this<Worker> {
 public:
  void start() {
    thread_ = std::thread([worker = shared_from_this()] { worker->run(); });
  }

  /// Gives a job and waits for the next step; nullopt: told to stop, and Python did not obey in time.
  std::optional<ScriptStep> ask(Job job, const std::function<bool()>& stopped) {
    std::unique_lock lock(mutex_);
    step_.reset();
    jobs_.push_back(std::move(job));
    changed_.notify_all();
    while (!changed_.wait_for(lock, kAskEvery, [this] { return step_.has_value(); })) {
      if (stopped && stopped()) break;
    }
    if (!step_) {
      interrupt(lock);
      if (!changed_.wait_for(lock, kGrace, [this] { return step_.has_value(); }))
        return std::nullopt;
    }
    return std::exchange(step_, std::nullopt);
  }

  /// Ends functions that wait for an answer.
  void abandon() {
    std::unique_lock lock(mutex_);
    if (depth_ == 0) return;
    interrupt(lock);
    changed_.wait_for(lock, kGrace, [this] { return depth_ == 0; });
    abandoned_ = false;
    step_.reset();
  }

  [[nodiscard]] bool idle() {
    const std::lock_guard lock(mutex_);
    return depth_ == 0;
  }
  void quit() {
    {
      const std::lock_guard lock(mutex_);
      jobs_.push_back({Job::Kind::quit, {}, {}});
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
  }
  /// The thread is left to itself.
  void leave() {
    if (thread_.joinable()) thread_.detach();
  }
  [[nodiscard]] bool is_this_thread() const {
    return std::this_thread::get_id() == thread_.get_id();
  }

  /// Called by Python: gives a step, waits for the answer. Work that comes meanwhile (a nested call) is done here.
  ScriptAnswer wait_for_answer(ScriptStep step) {
    const py::gil_scoped_release release;
    std::unique_lock lock(mutex_);
    post(std::move(step));
    for (;;) {
      changed_.wait(lock, [this] { return !jobs_.empty() || abandoned_; });
      if (abandoned_) break;
      Job job = std::move(jobs_.front());
      jobs_.pop_front();
      if (job.kind == Job::Kind::answer) return job.answer;
      if (job.kind == Job::Kind::quit) break;
      work(job, lock);
    }
    lock.unlock();
    const py::gil_scoped_acquire acquire;
    PyErr_SetString(abandoned_error, "the program was stopped");
    throw py::error_already_set();
  }

 private:
  void run() {
    this_worker = this;
    if (Py_IsInitialized() == 0) {
      py::initialize_interpreter(false);
      (void)PyEval_SaveThread();
    }
    std::unique_lock lock(mutex_);
    for (;;) {
      changed_.wait(lock, [this] { return !jobs_.empty(); });
      Job job = std::move(jobs_.front());
      jobs_.pop_front();
      if (job.kind == Job::Kind::quit) return;
      if (job.kind == Job::Kind::work) work(job, lock);
    }
  }

  void work(Job& job, std::unique_lock<std::mutex>& lock) {
    ++depth_;
    id_ = PyThread_get_thread_ident();
    lock.unlock();
    ScriptStep step;
    {
      const py::gil_scoped_acquire acquire;
      PyThreadState_SetAsyncExc(PyThread_get_thread_ident(), nullptr);  // one that came too late
      step = job.work();
      job.work = nullptr;
    }
    lock.lock();
    if (--depth_ == 0) abandoned_ = false;
    post(std::move(step));
  }

  void post(ScriptStep step) {
    step_ = std::move(step);
    changed_.notify_all();
  }

  /// Wakes what waits and raises Abandoned in what works. The GIL is fetched by a thread that nobody waits for.
  void interrupt(const std::unique_lock<std::mutex>&) {
    abandoned_ = true;
    changed_.notify_all();
    std::thread([worker = shared_from_this()] {
      const PyGILState_STATE state = PyGILState_Ensure();
      worker->raise_abandoned();
      PyGILState_Release(state);
    }).detach();
  }

  void raise_abandoned() {
    const std::lock_guard lock(mutex_);
    if (abandoned_ && depth_ > 0) PyThreadState_SetAsyncExc(id_, abandoned_error);
  }

  std::thread thread_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> jobs_;
  std::optional<ScriptStep> step_;
  int depth_{0};
  bool abandoned_{false};
  unsigned long id_{0};  ///< of the thread, as Python counts
};

// --- the compiled module ---

py::object number_tuple(const std::optional<ScriptNumber>& n) {
  if (!n) return py::none();
  return py::make_tuple(static_cast<int>(n->kind), n->value);
}

py::object tool_tuple(const ScriptTool& t) {
  return py::make_tuple(t.number, t.pocket, std::vector<double>(t.offset, t.offset + 9), t.diameter,
                        t.front_angle, t.back_angle, t.orientation);
}

template <class T>
py::object or_none(const std::optional<T>& v) {
  return v ? py::cast(*v) : py::object(py::none());
}

PYBIND11_EMBEDDED_MODULE(_kerf_interp, m) {
  m.def("number",
        [](const std::string& name, int i) { return number_tuple(self().number(name, i)); });
  m.def("set_number",
        [](const std::string& name, int i, double v) { return self().set_number(name, i, v); });
  m.def("text", [](const std::string& name) { return or_none(self().text(name)); });
  m.def("names", [] { return self().names(); });
  m.def("parameter", [](int i) { return or_none(self().parameter(i)); });
  m.def("set_parameter", [](int i, double v) { return self().set_parameter(i, v); });
  m.def("named_parameter",
        [](const std::string& name) { return or_none(self().parameter(std::string_view(name))); });
  m.def("set_named_parameter", [](const std::string& name, double v) {
    return self().set_parameter(std::string_view(name), v);
  });
  m.def("parameter_names", [] { return self().parameter_names(); });
  m.def("word", [](int level, char letter) { return or_none(self().word(level, letter)); });
  m.def("block_text",
        [](int level, const std::string& what) { return self().block_text(level, what); });
  m.def("block_number", [](int level, const std::string& what, int i) {
    return number_tuple(self().block_number(level, what, i));
  });
  m.def("call_text",
        [](int level, const std::string& what) { return or_none(self().call_text(level, what)); });
  m.def("tool", [](int n) {
    const auto tool = self().tool(n);
    return tool ? tool_tuple(*tool) : py::object(py::none());
  });
  m.def("tool_in_spindle", [] { return tool_tuple(self().tool_in_spindle()); });
  m.def("canon_names", [] { return self().canon_names(); });
  m.def("canon", [](const std::string& name, const py::list& arguments) {
    std::vector<ScriptArgument> all;
    for (const py::handle a : arguments) {
      ScriptArgument one;
      if (py::isinstance<py::str>(a))
        one.text = a.cast<std::string>();
      else
        one.number = a.cast<double>();
      all.push_back(std::move(one));
    }
    return self().canon(name, all);
  });
  m.def("glue", [](const std::string& name) { return self().glue(name); });
  m.def("set_error", [](std::string text) { self().set_error(std::move(text)); });
  m.def("error_text", [] { return self().error_text(); });
  m.def("execute", [](const std::string& text, int line) {
    if (this_worker == nullptr)
      throw std::runtime_error("execute() works in the function's thread");
    ScriptStep step;
    step.kind = ScriptStep::Kind::execute;
    step.text = text;
    step.line = line;
    const ScriptAnswer a = this_worker->wait_for_answer(std::move(step));
    return py::make_tuple(a.good, a.error, a.line, a.line_text);
  });
}

// --- functions ---

ScriptStep failed(std::string text, std::string help = {}) {
  ScriptStep step;
  step.kind = ScriptStep::Kind::failed;
  step.text = std::move(text);
  step.help = std::move(help);
  return step;
}

ScriptStep failed_by(const py::error_already_set& e, const std::string& where) {
  if (e.matches(abandoned_error)) return failed(where + " was stopped");
  return failed("pycall(" + where + ") failed: " + text_of(e), e.what());
}

/// What a prolog, an epilog or a python= function returned.
ScriptStep remap_result(const py::object& value, const std::string& where) {
  ScriptStep done;
  if (value.is_none()) return done;
  if (py::isinstance<py::str>(value)) return failed(value.cast<std::string>());
  if (!py::isinstance<py::int_>(value))
    return failed(where +
                  " must return INTERP_OK, INTERP_EXECUTE_FINISH, INTERP_ERROR or a text, not " +
                  py::str(py::type::of(value)).cast<std::string>());
  const int code = value.cast<int>();
  if (code == 2) done.finish_first = true;
  if (code < 3) return done;
  const std::string text = self().error_text();
  return failed(text.empty() ? where + " returned INTERP_ERROR" : text);
}

/// What an O-word sub or a named parameter returned.
ScriptStep number_result(const py::object& value, const std::string& where) {
  ScriptStep done;
  if (value.is_none()) return done;
  if (py::isinstance<py::str>(value)) return failed(value.cast<std::string>());
  if (!py::isinstance<py::int_>(value) && !py::isinstance<py::float_>(value))
    return failed(where + " must return a number, a text or nothing, not " +
                  py::str(py::type::of(value)).cast<std::string>());
  done.value = value.cast<double>();
  return done;
}

ScriptStep run_function(const py::object& function, const ScriptCall& call) {
  const std::string where = call.module + "." + call.function;
  const bool remap = call.module == "remap";
  self().set_error({});
  try {
    const py::object self_object = py::module_::import("interpreter").attr("this");
    py::list arguments;
    arguments.append(self_object);
    for (const double a : call.arguments) arguments.append(a);
    py::dict words;
    for (const auto& [name, value] : call.words) words[py::str(name)] = value;
    py::object value = function(*py::tuple(arguments), **words);
    while (PyGen_Check(value.ptr())) {
      PyObject* next = PyIter_Next(value.ptr());
      if (next == nullptr) {
        if (PyErr_Occurred() != nullptr) throw py::error_already_set();
        value = py::none();  // it ran to its end
        break;
      }
      const auto yielded = py::reinterpret_steal<py::object>(next);
      ScriptStep step = remap_result(yielded, where);
      if (step.kind == ScriptStep::Kind::failed || !step.finish_first) return step;
      step.kind = ScriptStep::Kind::finish;
      (void)this_worker->wait_for_answer(std::move(step));
    }
    return remap ? remap_result(value, where) : number_result(value, where);
  } catch (const py::error_already_set& e) {
    return failed_by(e, where);
  } catch (const std::exception& e) {
    return failed(where + ": " + e.what());
  }
}

void add_module(const char* name, const char* source) {
  const py::module_ types = py::module_::import("types");
  py::object module = types.attr("ModuleType")(name);
  py::module_::import("sys").attr("modules")[name] = module;
  py::exec(source, module.attr("__dict__"));
}

class PythonHost final : public ScriptHost {
 public:
  explicit PythonHost(PythonOptions options) : options_(std::move(options)) {}
  ~PythonHost() override {
    if (!worker_) return;
    if (worker_->idle())
      worker_->quit();
    else
      worker_->leave();
  }

  std::string attach(ScriptSelf& script_self) override {
    self_ = &script_self;
    const ScriptStep step = on_worker([this] { return load(); });
    return step.kind == ScriptStep::Kind::failed
               ? step.text + (step.help.empty() ? "" : "\n" + step.help)
               : std::string();
  }

  void detach() override {
    (void)on_worker([] {
      call_toplevel("__delete__");
      try {
        py::module_::import("atexit").attr("_run_exitfuncs")();
      } catch (const py::error_already_set&) {
      }
      return ScriptStep{};
    });
    self_ = nullptr;
  }

  bool has(std::string_view module, std::string_view function) override {
    if (options_.reload_on_change) reload_if_changed();
    const auto key = std::make_pair(std::string(module), std::string(function));
    if (const auto hit = known_.find(key); hit != known_.end()) return hit->second;
    const ScriptStep step = on_worker([&key] {
      ScriptStep found;
      if (!find(key.first, key.second).is_none()) found.value = 1;
      return found;
    });
    return known_[key] = step.value.has_value();
  }

  ScriptStep call(ScriptCall call) override {
    if (options_.reload_on_change) reload_if_changed();
    return on_worker([call = std::move(call)] {
      const py::object function = find(call.module, call.function);
      if (function.is_none())
        return failed("'" + call.function + "' is not a Python callable function");
      return run_function(function, call);
    });
  }

  ScriptStep resume(const ScriptAnswer& answer) override {
    return ask({Job::Kind::answer, {}, answer});
  }

  ScriptStep run(std::string_view statement) override {
    return on_worker([text = std::string(statement)] {
      try {
        py::dict scope = py::module_::import("__main__").attr("__dict__");
        const py::object interpreter = py::module_::import("interpreter").attr("this");
        scope["self"] = interpreter;
        scope["this"] = interpreter;
        std::string line = text.substr(std::min(text.find_first_not_of(" \t"), text.size()));
        py::exec(line, scope);
      } catch (const py::error_already_set& e) {
        return failed_by(e, "py comment");
      }
      return ScriptStep{};
    });
  }

  void abandon() override {
    if (worker_) worker_->abandon();
  }

 private:
  static py::object find(const std::string& module, const std::string& function) {
    const py::dict modules = py::module_::import("sys").attr("modules");
    if (!modules.contains(module)) return py::none();
    // What the module itself has: every module has an __init__ of its type.
    const py::object found =
        modules[py::str(module)].attr("__dict__").attr("get")(function, py::none());
    return PyCallable_Check(found.ptr()) != 0 ? found : py::object(py::none());
  }

  static void call_toplevel(const char* name) {
    try {
      const py::object top = find("__kerf_toplevel__", name);
      if (!top.is_none()) top(py::module_::import("interpreter").attr("this"));
    } catch (const py::error_already_set& e) {
      std::fprintf(stderr, "%s: %s\n", name, e.what());
    }
  }

  ScriptStep load() {
    try {
      if (abandoned_error == nullptr) {
        abandoned_error = PyErr_NewException("interpreter.Abandoned", PyExc_BaseException, nullptr);
        add_module("interpreter", kInterpreterModule);
        add_module("emccanon", kCanonModule);
      }
      // What functions of the interpreter before have added to `self` goes.
      const py::object self = py::module_::import("interpreter").attr("this");
      self.attr("__dict__").attr("clear")();
      self.attr("__init__")();
      const py::module_ sys = py::module_::import("sys");
      // Compiled files know the time of their source in whole seconds; a second change within one would not be seen.
      if (options_.reload_on_change) sys.attr("dont_write_bytecode") = true;
      py::list path = sys.attr("path");
      for (auto i = options_.path_prepend.rbegin(); i != options_.path_prepend.rend(); ++i)
        path.insert(0, *i);
      for (const std::string& folder : options_.path_append) path.append(folder);
      // A machine's own stdglue.py comes before ours.
      const py::object spec = py::module_::import("importlib.util").attr("find_spec");
      const py::dict modules = py::module_::import("sys").attr("modules");
      if (!modules.contains("stdglue") && spec("stdglue").is_none())
        add_module("stdglue", kGlueModule);
      run_toplevel();
    } catch (const py::error_already_set& e) {
      return failed("[PYTHON]TOPLEVEL " + options_.toplevel + ": " + text_of(e), e.what());
    }
    call_toplevel("__init__");
    return {};
  }

  void run_toplevel() {
    watch(options_.toplevel);
    const py::object module = py::module_::import("types").attr("ModuleType")("__kerf_toplevel__");
    py::module_::import("sys").attr("modules")["__kerf_toplevel__"] = module;
    py::eval_file(options_.toplevel, module.attr("__dict__"));
    for (const py::object& found : modules_with_functions())
      if (py::hasattr(found, "__file__")) watch(py::str(found.attr("__file__")));
  }

  /// The modules whose functions programs call, as far as the script imported them.
  static std::vector<py::object> modules_with_functions() {
    const py::dict modules = py::module_::import("sys").attr("modules");
    std::vector<py::object> found;
    for (const char* name : {"remap", "oword", "namedparams"})
      if (modules.contains(name)) found.emplace_back(modules[name]);
    return found;
  }

  /// A change of the file behind the first of these calls counts.
  void watch(const std::string& path) {
    std::error_code ec;
    watched_.try_emplace(path, std::filesystem::last_write_time(path, ec));
  }

  /// A file that is missing just now is being written.
  [[nodiscard]] bool changed() const {
    return std::any_of(watched_.begin(), watched_.end(), [](const auto& file) {
      std::error_code ec;
      return std::filesystem::last_write_time(file.first, ec) != file.second && !ec;
    });
  }

  /// RELOAD_ON_CHANGE: the script and its modules anew. One that is wrong leaves the functions as they were.
  void reload_if_changed() {
    if (!changed()) return;
    known_.clear();
    (void)on_worker([this] {
      // The times before the files are read: what changes meanwhile is read again.
      for (auto& [path, time] : watched_) {
        std::error_code ec;
        time = std::filesystem::last_write_time(path, ec);
      }
      try {
        const py::object reload = py::module_::import("importlib").attr("reload");
        for (const py::object& module : modules_with_functions()) reload(module);
        run_toplevel();
      } catch (const py::error_already_set& e) {
        std::fprintf(stderr, "%s: %s\n", options_.toplevel.c_str(), e.what());
      }
      return ScriptStep{};
    });
  }

  ScriptStep on_worker(std::function<ScriptStep()> work) {
    // A named parameter that a function reads is a function too.
    if (worker_ && worker_->is_this_thread()) return work();
    return ask({Job::Kind::work, std::move(work), {}});
  }

  ScriptStep ask(Job job) {
    if (!worker_) {
      worker_ = std::make_shared<Worker>();
      worker_->start();
    }
    std::fflush(nullptr);  // texts of both come out in their order
    self_in_use = self_;
    const bool work = job.kind == Job::Kind::work;
    if (work) {
      job.work = [inner = std::move(job.work)] {
        ScriptStep step = inner();
        try {
          py::module_::import("sys").attr("stdout").attr("flush")();
        } catch (const py::error_already_set&) {
        }
        return step;
      };
    }
    auto step = worker_->ask(std::move(job), options_.stopped);
    if (step) return std::move(*step);
    // It works on without us; the next call gets another thread.
    worker_->leave();
    worker_.reset();
    return failed("a Python function did not end when the program was stopped; it was abandoned");
  }

  PythonOptions options_;
  std::shared_ptr<Worker> worker_;
  ScriptSelf* self_{nullptr};
  std::map<std::pair<std::string, std::string>, bool> known_;
  std::map<std::string, std::filesystem::file_time_type> watched_;
};

}  // namespace

}  // namespace kerf::interp

extern "C" __attribute__((visibility("default"))) kerf::interp::ScriptHost* kerf_make_python_host(
    const kerf::interp::PythonOptions& options) {
  return new kerf::interp::PythonHost(options);
}
