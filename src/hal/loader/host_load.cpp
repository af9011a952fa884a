// Host: loadrt and unloadrt.
#include <algorithm>
#include <new>

#include "hal/core/value_text.hpp"
#include "hal/loader/c_modules.hpp"
#include "hal/loader/c_parameters.hpp"
#include "hal/loader/host.hpp"
#include "hal/loader/live_builder.hpp"
#include "rtapi/base/suggest.hpp"

namespace kerf::hal {

using rtapi::Errc;
using rtapi::fail;
using rtapi::Result;
using rtapi::Status;

namespace {

constexpr std::size_t kCacheLine = 64;
/// A typing error must not take the machine's memory; what fits is for [KERF]SEGMENT_MB to say.
constexpr std::int64_t kMostInstances = 100'000;

std::string quoted(std::string_view s) { return "'" + std::string(s) + "'"; }

std::string with_underscores(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

using Args = std::map<std::string, std::string, std::less<>>;

/// NAME=VALUE words. Double quotes are taken out wherever they are, single ones when they enclose the value.
Result<Args> parse_args(std::span<const std::string> words) {
  Args args;
  for (std::string word : words) {
    std::erase(word, '"');
    const auto equals = word.find('=');
    if (equals == std::string::npos || equals == 0) {
      return fail(Errc::bad_argument, "Unknown parameter `" + word + "'; expected NAME=VALUE");
    }
    std::string value = word.substr(equals + 1);
    if (value.size() >= 2 && value.front() == '\'' && value.back() == '\'')
      value = value.substr(1, value.size() - 2);
    args[word.substr(0, equals)] = value;
  }
  return args;
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const auto end = std::min(text.find(',', begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

struct InstanceWish {
  std::string prefix;
  std::int64_t personality;
};

/// What the loader's own parameters ask for; takes them out of `args`.
Result<std::vector<InstanceWish>> instances(const Info& info, Args& args) {
  std::vector<InstanceWish> out;
  const auto take = [&](const char* name) -> std::string {
    const auto it = args.find(name);
    if (it == args.end()) return {};
    std::string value = it->second;
    args.erase(it);
    return value;
  };
  if (info.singleton && !info.own_names) {
    for (const char* own : {"count", "names"}) {
      if (args.count(own) > 0) {
        return fail(Errc::bad_argument,
                    std::string(info.name) + " has one instance only: " + own + "= is not for it");
      }
    }
  }
  const std::string count_text = info.own_names ? "" : take("count");
  const std::string names_text = info.own_names ? "" : take("names");
  const std::string personality_text = take("personality");
  if (!count_text.empty() && !names_text.empty()) {
    return fail(Errc::bad_argument, "count= and names= are mutually exclusive");
  }
  std::int64_t count = 0;
  if (!count_text.empty()) {
    const auto value = parse_value(Type::s64, count_text);
    if (!value.ok()) {
      return fail(Errc::bad_argument,
                  "`" + count_text + "' invalid for parameter `count=" + count_text + "'");
    }
    count = from_raw<std::int64_t>(*value);
    if (count < 0 || count > kMostInstances) {
      return fail(Errc::bad_argument, "count=" + count_text + " is not between 0 and " +
                                          std::to_string(kMostInstances));
    }
  }
  if (info.singleton) {
    out.push_back({std::string(info.name), 0});
  } else if (!names_text.empty()) {
    for (auto& name : split(names_text)) {
      if (name.empty())
        return fail(Errc::bad_argument, "names=" + names_text + " has an empty name");
      out.push_back({std::move(name), 0});
    }
  } else {
    if (count == 0) count = info.default_count;
    for (std::int64_t i = 0; i < count; ++i) {
      out.push_back({std::string(info.name) + "." + std::to_string(i), 0});
    }
  }
  if (!personality_text.empty()) {
    const auto values = split(personality_text);
    for (std::size_t i = 0; i < values.size() && i < out.size(); ++i) {
      const auto value = parse_value(Type::s64, values[i]);
      if (!value.ok())
        return fail(Errc::bad_argument, "`" + values[i] + "' invalid for parameter `personality'");
      out[i].personality = from_raw<std::int64_t>(*value);
    }
  }
  return out;
}

}  // namespace

Reply Host::load(Words argv) {
  const std::string& name = argv[0];
  const auto error = [&](const rtapi::Error& e) {
    return Reply{static_cast<int>(e.code), name + ": " + e.message()};
  };
  if (find_loaded(name) != nullptr) {
    return {static_cast<int>(Errc::exists), name + ": already exists"};
  }
  if (abandoned_.count(with_underscores(name)) > 0) {
    return {static_cast<int>(Errc::busy),
            name + ": the one before has not returned from rtapi_app_exit; end HAL first"};
  }
  auto module = modules_.open(name);
  if (!module.ok()) return {static_cast<int>(module.error().code), module.error().message()};
  if ((*module)->c_library != nullptr) return c_modules_->load(name, argv.subspan(1), **module);
  auto args = parse_args(argv.subspan(1));
  if (!args.ok()) {
    modules_.close(*module);
    return error(args.error());
  }
  auto wishes = instances((*module)->info, *args);
  std::string given;
  for (const auto& word : argv.subspan(1)) given += (given.empty() ? "" : " ") + word;
  auto record = wishes.ok()
                    ? registry_->add_component(name, ComponentKind::realtime, 0, given, true)
                    : Result<ComponentRecord*>(rtapi::Failure{wishes.error()});
  if (!record.ok()) {
    modules_.close(*module);
    return error(record.error());
  }

  auto loaded = std::make_unique<Loaded>();
  loaded->name = name;
  loaded->module = *module;
  loaded->record = *record;
  Loaded& l = *loaded;
  LiveBuilder builder(*this, l, std::move(*args));
  // All instances in one piece, from the beginning of a cache line: threads run through them in order, as a rule.
  const std::size_t stride =
      (l.module->size + l.module->align - 1) / l.module->align * l.module->align;
  auto* all =
      static_cast<std::byte*>(builder.allocate(std::max<std::size_t>(stride * wishes->size(), 1),
                                               std::max<std::size_t>(l.module->align, kCacheLine)));
  for (const auto& wish : *wishes) {
    if (all == nullptr) break;
    builder.begin_instance(wish.prefix, wish.personality);
    std::byte* storage = all + l.instances.size() * stride;
    l.module->create(storage, builder);
    l.instances.push_back({storage});
    if (builder.failed()) break;
  }
  builder.show_times();
  if (!builder.failed()) {
    if (auto unknown = builder.unknown_arg(); !unknown.empty()) builder.fail(unknown);
  }
  loaded_.push_back(std::move(loaded));
  for (const auto& thread : builder.threads()) {
    if (builder.failed()) break;
    if (auto status = add_thread(l, thread.name, thread.period_ns); !status.ok()) {
      builder.fail(status.error().message());
    }
  }
  std::size_t started = 0;
  for (auto* participant : l.participants) {
    if (builder.failed()) break;
    if (driver_ == nullptr) continue;
    if (auto status = driver_->participant_added(*participant); !status.ok()) {
      builder.fail(status.error().message());
    } else {
      ++started;
    }
  }
  if (builder.failed()) {
    l.participants.resize(driver_ == nullptr ? 0 : started);
    (void)destroy(l);  // one of C is not loaded here
    loaded_.pop_back();
    return {static_cast<int>(Errc::bad_argument), name + ": " + builder.error()};
  }
  for (auto* block : l.blocks) registry_->show_memory(*block);
  registry_->set_ready(*l.record);
  give_later_aliases();
  return {};
}

Reply Host::list_parameters(Words argv) {
  // One that is loaded must not be opened again: closing it would be its end.
  const Loaded* loaded = find_loaded(argv[0]);
  const Module* module = loaded != nullptr ? loaded->module : nullptr;
  if (module == nullptr) {
    auto opened = modules_.open(argv[0]);
    if (!opened.ok()) return {static_cast<int>(opened.error().code), opened.error().message()};
    module = *opened;
  }
  std::string names(module->info.lists);
  if (module->c_library != nullptr) {
    for (const auto& p : c_parameters(module->c_library))
      if (p.elements > 0) names += (names.empty() ? "" : " ") + p.name;
  }
  if (loaded == nullptr) modules_.close(module);
  return {0, names};
}

void Host::abandon(Loaded& loaded) {
  for (auto* function : loaded.functions) {
    function->runs_once = 0;
    forget_function(function);
  }
  const auto it = std::find_if(loaded_.begin(), loaded_.end(),
                               [&](const auto& l) { return l.get() == &loaded; });
  // Its code may run on until the process ends.
  static auto& kept = *new std::vector<std::unique_ptr<Loaded>>;
  abandoned_.insert(with_underscores((*it)->name));
  kept.push_back(std::move(*it));
  loaded_.erase(it);
}

Status Host::destroy(Loaded& l) {
  if (l.c != nullptr) KERF_CHECK(c_modules_->stop(l));
  for (auto it = l.participants.rbegin(); it != l.participants.rend(); ++it) {
    if (driver_ != nullptr) driver_->participant_removed(**it);
  }
  remove_threads(l);
  // The pins go before the objects that they stand in: unlinking writes to both.
  if (l.record != nullptr) registry_->remove_component(*l.record);
  for (auto it = l.instances.rbegin(); it != l.instances.rend(); ++it)
    l.module->destroy(it->object);
  for (auto* function : l.functions) forget_function(function);
  for (const auto& service : l.services) services_.erase(service);
  for (auto* block : l.blocks) registry_->remove_memory(*block);
  for (const auto& m : l.memory) ::operator delete(m.data, std::align_val_t(m.align));
  l.memory.clear();
  modules_.close(l.module);
  registry_->reclaim();
  return {};
}

Status Host::unload_one(Loaded& loaded) {
  KERF_CHECK(c_modules_->check_tasks(loaded));
  KERF_CHECK(drop_functions(loaded));
  KERF_CHECK(wait_for_grace());
  for (const auto& t : threads_) {
    if (t->owner != &loaded) continue;
    if (loaded.functions.empty()) {
      // Made by a component that does nothing but make threads: they stand on their own from now on.
      t->owner = nullptr;
    } else {
      KERF_CHECK(publish_list(*t, {}));  // functions of others in it are free again
    }
  }
  for (const auto& other : loaded_) other->uses.erase(&loaded);
  if (auto status = destroy(loaded); !status.ok()) {
    abandon(loaded);
    return status;
  }
  std::erase_if(loaded_, [&](const auto& l) { return l.get() == &loaded; });
  return {};
}

Status Host::unload_thread(Thread& thread) {
  KERF_CHECK(publish_list(thread, {}));
  KERF_CHECK(wait_for_grace());  // one that hangs cannot be joined
  remove_thread(thread);
  return {};
}

Reply Host::unload(Words argv) {
  const auto reply = [](const Status& status) {
    if (status.ok()) return Reply{};
    return Reply{static_cast<int>(status.error().code), status.error().message()};
  };
  if (argv[0] == "all") return reply(unload_all());
  Loaded* loaded = find_loaded(argv[0]);
  if (loaded == nullptr) {
    std::vector<std::string> known;
    for (const auto& l : loaded_) known.push_back(l->name);
    for (const auto& t : threads_) {
      if (t->owner != nullptr) continue;
      if (t->component->name == argv[0]) return reply(unload_thread(*t));
      known.emplace_back(t->component->name.view());
    }
    return {static_cast<int>(Errc::not_found), "component " + quoted(argv[0]) + " is not loaded" +
                                                   rtapi::did_you_mean(argv[0], known)};
  }
  for (const auto& other : loaded_) {
    if (other->uses.count(loaded) > 0) {
      return reply(fail(Errc::busy, "component " + quoted(loaded->name) + " is in use by " +
                                        quoted(other->name)));
    }
  }
  return reply(unload_one(*loaded));
}

Status Host::unload_all() {
  if (registry_ == nullptr) return {};
  registry_->set_running(false);
  for (const auto& l : loaded_) KERF_CHECK(c_modules_->check_tasks(*l));
  // Out of the threads first, all at once: one grace is enough, and if a function hangs nothing is taken away beneath it.
  // Without HAL memory not even an empty list can be published; the threads are stopped before their functions go all the same.
  for (const auto& t : threads_) (void)publish_list(*t, {});
  KERF_CHECK(wait_for_grace());
  while (!threads_.empty()) remove_thread(*threads_.back());
  Status all;
  while (!loaded_.empty()) {
    auto status = destroy(*loaded_.back());
    if (status.ok()) {
      loaded_.pop_back();
      continue;
    }
    abandon(*loaded_.back());
    if (all.ok()) all = status;
  }
  if (all.ok() && !abandoned_.empty())
    return fail(Errc::busy, "component " + quoted(*abandoned_.begin()) +
                                " has not returned from rtapi_app_exit");
  return all;
}

}  // namespace kerf::hal
