// Host: threads and their function lists.
#include <algorithm>
#include <bit>

#include "hal/core/value_text.hpp"
#include "hal/loader/c_function.hpp"
#include "hal/loader/host.hpp"
#include "rtapi/base/suggest.hpp"

namespace kerf::hal {

using rtapi::Errc;
using rtapi::fail;
using rtapi::Status;

namespace {

std::string quoted(std::string_view s) { return "'" + std::string(s) + "'"; }

Reply error(Errc code, std::string text) { return {static_cast<int>(code), std::move(text)}; }

Reply no_function(const Registry& registry, const std::string& name) {
  return error(Errc::not_found, "function " + quoted(name) + " not found" +
                                    rtapi::did_you_mean(name, registry.names(Kind::function)));
}

Reply in_one_thread(const std::string& function) {
  return error(Errc::busy, "function " + quoted(function) + " may only be added to one thread");
}

constexpr std::int64_t kShortestPeriodNs = 1'000;
constexpr std::int64_t kLongestPeriodNs = 1'000'000'000;

Reply reply(const Status& status) {
  if (status.ok()) return {};
  return {static_cast<int>(status.error().code), status.error().message()};
}

}  // namespace

Status Host::add_thread(Loaded& owner, std::string_view name, std::int64_t period_ns) {
  if (period_ns < kShortestPeriodNs || period_ns > kLongestPeriodNs) {
    return fail(Errc::bad_argument, "thread " + quoted(name) + ": period " +
                                        std::to_string(period_ns) +
                                        " ns is not between 1000 and 1000000000");
  }
  for (const auto& t : threads_) {
    // Priorities and CPUs are given in the order of creation.
    if (period_ns < t->runner->period_ns()) {
      return fail(Errc::bad_argument, "new thread period " + std::to_string(period_ns) +
                                          " is less than the period " +
                                          std::to_string(t->runner->period_ns()) + " of thread " +
                                          quoted(t->runner->name()) + ": make the fastest first");
    }
  }
  // Each thread shows as a component of its own, so that its items have an owner that scripts know.
  const std::string base(name);
  KERF_TRY(ComponentRecord * component,
           registry_->add_component("__" + base, ComponentKind::realtime));
  auto thread = std::make_unique<Thread>();
  const auto build = [&]() -> Status {
    KERF_TRY(ThreadRecord * record, registry_->add_thread(*component, base, period_ns));
    thread->component = component;
    thread->owner = &owner;
    thread->runner =
        std::make_unique<ThreadRunner>(segment(), registry_->root(), *record, counter_);
    ThreadRunner::Items& items = thread->runner->items();
    const auto add_out = [&](auto& pin, const char* suffix, Type type) -> Status {
      const std::string whole = base + suffix;
      ItemSpec spec{.name = whole, .type = type, .dir = Dir::out, .cell = pin.place().word()};
      spec.owner_base = reinterpret_cast<std::uintptr_t>(segment().base());
      if (auto made = registry_->add_pin(*component, spec); !made.ok())
        return rtapi::Failure{made.error()};
      return {};
    };
    KERF_CHECK(add_out(items.time, ".time", Type::s32));
    KERF_CHECK(add_out(items.threadbeat, ".threadbeat", Type::s64));
    KERF_TRY(const ItemRecord* tmax,
             registry_->add_param(*component, base + ".tmax", Type::s32, Dir::rw, 0));
    items.tmax.place() = registry_->fixed_slot(*tmax);
    KERF_CHECK(publish_list(*thread, {}));
    if (driver_ != nullptr) KERF_CHECK(driver_->thread_added(*thread->runner));
    threads_.push_back(std::move(thread));
    return {};
  };
  if (auto status = build(); !status.ok()) {
    registry_->remove_component(*component);
    return status;
  }
  registry_->set_ready(*component);
  ++thread_changes_;
  return {};
}

void Host::remove_thread(Thread& thread) {
  if (driver_ != nullptr) driver_->thread_removed(*thread.runner);
  const ThreadRecord* record = &thread.runner->record();
  std::erase_if(old_lists_, [&](const OldList& old) { return old.thread == record; });
  registry_->remove_component(*thread.component);
  std::erase_if(threads_, [&](const auto& t) { return t.get() == &thread; });
  ++thread_changes_;
}

void Host::remove_threads(const Loaded& owner) {
  for (std::size_t i = threads_.size(); i > 0; --i) {
    if (threads_[i - 1]->owner == &owner) remove_thread(*threads_[i - 1]);
  }
}

Status Host::publish_list(Thread& thread, std::vector<FunctionRecord*> functions) {
  const std::size_t before = thread.functions.size();
  auto store = thread.store;
  // Functions are added at the end as a rule: then the list grows where it stands, and a thousand cost no more than a thousand times one.
  const bool grows =
      store != nullptr && functions.size() <= store->entries.size() && functions.size() >= before &&
      std::equal(thread.functions.begin(), thread.functions.end(), functions.begin());
  if (!grows) {
    store = std::make_shared<RunStore>();
    const std::size_t room = std::bit_ceil(std::max<std::size_t>(functions.size() + 1, 16));
    store->entries.resize(room);
  }
  for (std::size_t i = grows ? before : 0; i < functions.size(); ++i)
    store->entries[i] = functions_.at(functions[i]);
  auto list = std::make_unique<RunList>(RunList{store->entries.data(), functions.size()});
  ThreadRecord& record = thread.runner->record();
  if (grows && functions.size() == before + 1) {
    KERF_CHECK(registry_->insert_in_run_list(record, before, *functions.back()));
  } else {
    KERF_CHECK(registry_->set_run_list(record, functions));
  }
  std::erase_if(old_lists_, [](const OldList& old) {
    return old.thread->ticking.get() == 0 || old.thread->cycles.observe() > old.cycles;
  });
  thread.runner->swap_list(list.get());
  // Counted after the swap: the cycle that runs now, number cycles + 1, may be in the old list; the one after it is not.
  rtapi::full_fence();
  const std::uint64_t cycles = record.cycles.observe();
  if (thread.list != nullptr) {
    old_lists_.push_back({&record, cycles, std::move(thread.store), std::move(thread.list)});
  }
  thread.store = std::move(store);
  thread.list = std::move(list);
  thread.functions = std::move(functions);
  return {};
}

Status Host::wait_for_grace() {
  std::vector<std::pair<ThreadRecord*, std::uint64_t>> seen;
  for (const auto& t : threads_) {
    ThreadRecord& record = t->runner->record();
    if (record.ticking.get() != 0) seen.emplace_back(&record, record.cycles.observe());
  }
  for (int attempt = 0;; ++attempt) {
    std::erase_if(seen, [](const auto& s) {
      return s.first->ticking.get() == 0 || s.first->cycles.observe() > s.second;
    });
    if (seen.empty()) return {};
    if (driver_ == nullptr || !driver_->wait_for_threads(attempt)) break;
  }
  const auto* running = registry_->at<FunctionRecord>(seen.front().first->running.get());
  return fail(
      Errc::busy,
      "thread " + quoted(seen.front().first->name) + " does not end its cycle" +
          (running == nullptr ? std::string() : "; it is in function " + quoted(running->name)));
}

Status Host::drop_functions(const Loaded& loaded) {
  // Those of a C module may belong to several components, or only some of them are meant.
  const auto own = [&, owner = loaded.record == nullptr
                                   ? Offset{0}
                                   : segment().offset_of(loaded.record)](const FunctionRecord* f) {
    if (owner != 0) return f->owner == owner;
    return std::find(loaded.functions.begin(), loaded.functions.end(), f) != loaded.functions.end();
  };
  for (const auto& t : threads_) {
    auto rest = t->functions;
    std::erase_if(rest, own);
    if (rest.size() != t->functions.size()) KERF_CHECK(publish_list(*t, std::move(rest)));
  }
  return {};
}

Reply Host::add_function(Words argv) {
  if (FunctionRecord* function = registry_->find_function(argv[0]); function != nullptr)
    run_always(*function);
  return put_in_list(argv);
}

void Host::run_always(FunctionRecord& function) {
  if (function.users > 0 || function.runs_once == 0) return;
  RunEntry& entry = functions_.at(&function);
  const auto* once = static_cast<const OnceFunction*>(entry.object);
  entry.object = once->object;
  entry.thunk = once->thunk;
  function.runs_once = 0;
}

Reply Host::put_in_list(Words argv) {
  FunctionRecord* function = registry_->find_function(argv[0]);
  if (function == nullptr) return no_function(*registry_, argv[0]);
  if (functions_.count(function) == 0)
    return error(Errc::busy, "the component of function " + quoted(argv[0]) + " is abandoned");
  // One that is run once knows of one list only.
  if (function->users > 0 && (function->reentrant == 0 || function->runs_once != 0))
    return in_one_thread(argv[0]);
  Thread* thread = find_thread(argv[1]);
  if (thread == nullptr) {
    return error(Errc::not_found, "thread " + quoted(argv[1]) + " not found" +
                                      rtapi::did_you_mean(argv[1], registry_->names(Kind::thread)));
  }
  auto list = thread->functions;
  const auto size = static_cast<std::int64_t>(list.size());
  std::int64_t position = -1;
  if (argv.size() > 2) {
    const auto parsed = parse_value(Type::s32, argv[2]);
    if (!parsed.ok() || from_raw<std::int32_t>(*parsed) == 0) {
      return error(Errc::bad_argument, "bad position: " + argv[2]);
    }
    position = from_raw<std::int32_t>(*parsed);
  }
  // From the front 1, 2, ...; from the end -1, -2, ...
  const std::int64_t index = position > 0 ? position - 1 : size + 1 + position;
  if (index < 0) return error(Errc::bad_argument, "position " + quoted(argv[2]) + " is too low");
  if (index > size)
    return error(Errc::bad_argument, "position " + quoted(argv[2]) + " is too high");
  list.insert(list.begin() + index, function);
  return reply(publish_list(*thread, std::move(list)));
}

Reply Host::add_init_function(Words argv) {
  FunctionRecord* function = registry_->find_function(argv[0]);
  if (function == nullptr) return no_function(*registry_, argv[0]);
  if (function->users > 0) return in_one_thread(argv[0]);
  if (functions_.count(function) == 0) return put_in_list(argv);  // which says why not
  run_always(*function);
  RunEntry& entry = functions_.at(function);
  auto once = std::make_unique<OnceFunction>();
  once->thunk = entry.thunk;
  once->object = entry.object;
  // What the list holds while the function is in it; run_always() puts its own code back.
  entry.thunk = &run_once;
  entry.object = once.get();
  Reply done = put_in_list(argv);
  if (done.ok()) {
    function->runs_once = 1;
    once_[function].push_back(std::move(once));
  } else {
    entry.thunk = once->thunk;
    entry.object = once->object;
  }
  return done;
}

void Host::forget_function(FunctionRecord* function) {
  functions_.erase(function);
  once_.erase(function);
}

Reply Host::delete_function(Words argv) {
  FunctionRecord* function = registry_->find_function(argv[0]);
  if (function == nullptr) return no_function(*registry_, argv[0]);
  if (function->users == 0)
    return error(Errc::bad_argument, "function " + quoted(argv[0]) + " is not in use");
  Thread* thread = find_thread(argv[1]);
  if (thread == nullptr) {
    return error(Errc::not_found, "thread " + quoted(argv[1]) + " not found" +
                                      rtapi::did_you_mean(argv[1], registry_->names(Kind::thread)));
  }
  auto list = thread->functions;
  const auto it = std::find(list.begin(), list.end(), function);
  if (it == list.end()) {
    return error(Errc::not_found, "thread " + quoted(argv[1]) + " doesn't use " + argv[0]);
  }
  list.erase(it);
  auto status = publish_list(*thread, std::move(list));
  // A thread may still be in the old list: the OnceFunction stays until the component goes.
  if (status.ok()) run_always(*function);
  return reply(status);
}

}  // namespace kerf::hal
