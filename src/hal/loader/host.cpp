#include "hal/loader/host.hpp"

#include <algorithm>
#include <new>

#include "hal/core/value_text.hpp"
#include "hal/loader/batch.hpp"
#include "hal/loader/c_function.hpp"
#include "hal/loader/c_modules.hpp"
#include "rtapi/base/suggest.hpp"
#include "rtapi/log/log.hpp"

namespace kerf::hal {

using rtapi::Errc;
using rtapi::fail;
using rtapi::Result;
using rtapi::Status;

namespace {

std::string quoted(std::string_view s) { return "'" + std::string(s) + "'"; }

Reply reply(const Status& status) {
  if (status.ok()) return {};
  return {static_cast<int>(status.error().code), status.error().message()};
}

Reply bad(Errc code, std::string text) { return {static_cast<int>(code), std::move(text)}; }

}  // namespace

/// One command: its name, how many words may follow, what the lock forbids, and who does it.
struct Host::Row {
  const char* name;
  std::size_t min;
  std::size_t max;
  std::uint32_t lock;
  Reply (Host::*run)(Words argv);
};

std::span<const Host::Row> Host::rows() {
  static constexpr Row kRows[] = {
      {"batch", 1, SIZE_MAX, 0, &Host::batch},
      {"debug", 1, 1, 0, &Host::debug},
      {"loadrt", 1, SIZE_MAX, lock_load, &Host::load},
      {"unloadrt", 1, 1, lock_load, &Host::unload},
      {"list-parameters", 1, 1, 0, &Host::list_parameters},
      {"net", 1, SIZE_MAX, lock_config, &Host::net},
      {"newsig", 2, 2, lock_config, &Host::new_signal},
      {"delsig", 1, 1, lock_config, &Host::delete_signal},
      {"linkps", 2, 2, lock_config, &Host::link_pin_signal},
      {"linksp", 2, 2, lock_config, &Host::link_signal_pin},
      {"linkpp", 2, 2, lock_config, &Host::link_pins},
      {"unlinkp", 1, 1, lock_config, &Host::unlink},
      {"setp", 2, 2, lock_params, &Host::set_item},
      {"sets", 2, 2, lock_params, &Host::set_signal},
      {"alias", 3, 3, lock_config, &Host::alias},
      {"unalias", 2, 2, lock_config, &Host::unalias},
      {"alias-later", 2, 2, 0, &Host::alias_later},
      {"addf", 2, 3, lock_config, &Host::add_function},
      {"initf", 2, 3, lock_config, &Host::add_init_function},
      {"delf", 2, 2, lock_config, &Host::delete_function},
      {"start", 0, 0, lock_run, &Host::start},
      {"stop", 0, 0, lock_run, &Host::stop},
      {"lock", 0, 1, 0, &Host::lock},
      {"unlock", 0, 1, 0, &Host::unlock},
      {"lock-bits", 1, 1, 0, &Host::lock_bits},
      {"timing", 1, 1, 0, &Host::timing},
      {"comp-new", 1, 2, 0, &Host::component_new},
      {"pin-new", 4, 6, 0, &Host::pin_new},
      {"param-new", 4, 6, 0, &Host::param_new},
      {"comp-ready", 1, 1, 0, &Host::component_ready},
      {"comp-unready", 1, 1, 0, &Host::component_unready},
      {"comp-exit", 1, 1, 0, &Host::component_exit},
      {"mem-new", 1, 1, 0, &Host::memory_new},
      {"shm-new", 3, 3, 0, &Host::named_memory_new},
      {"shm-drop", 1, 1, 0, &Host::named_memory_drop},
      {"hold-values", 0, 0, 0, &Host::hold_values},
      {"check-invariants", 0, 0, 0, &Host::check_invariants},
  };
  return kRows;
}

Result<std::unique_ptr<Host>> Host::create(rtapi::Segment& segment, const rtapi::Clock& clock,
                                           ModuleSource& modules, HostDriver* driver) {
  std::unique_ptr<Host> host(new Host(clock, modules, driver));
  KERF_TRY(host->registry_, Registry::create(segment));
  if (!clock.is_virtual()) host->counter_ = rtapi::CycleCounter::monotonic();
  return host;
}

Host::Host(const rtapi::Clock& clock, ModuleSource& modules, HostDriver* driver)
    : clock_(clock),
      modules_(modules),
      driver_(driver),
      c_modules_(std::make_unique<CModules>(*this)) {}

Host::~Host() { (void)unload_all(); }

Host::Loaded::Loaded() = default;
Host::Loaded::~Loaded() = default;

Reply Host::nested_command(Words argv) {
  const Caller caller = caller_;
  Reply done = command(argv);
  caller_ = caller;
  return done;
}

Reply Host::command(Words argv, const Caller& caller) {
  if (argv.empty()) return {};
  for (const Row& row : rows()) {
    if (argv[0] != row.name) continue;
    const std::size_t given = argv.size() - 1;
    if (given < row.min || given > row.max) {
      const std::string least = row.min == row.max ? ""
                                : given < row.min  ? "at least "
                                                   : "at most ";
      const std::size_t want = given < row.min ? row.min : row.max;
      return bad(Errc::bad_argument, argv[0] + " requires " + least + std::to_string(want) +
                                         " arguments, " + std::to_string(given) + " given");
    }
    if (const auto locked = registry_->check_lock(row.lock); !locked.ok()) return reply(locked);
    caller_ = caller;
    registry_->reclaim();
    return (this->*row.run)(argv.subspan(1));
  }
  std::vector<std::string> known;
  for (const Row& row : rows()) known.emplace_back(row.name);
  return bad(Errc::not_found,
             "Unknown command " + quoted(argv[0]) + rtapi::did_you_mean(argv[0], known));
}

Reply Host::batch(Words argv) {
  const auto batch = decode_batch(argv);
  if (!batch) return bad(Errc::protocol, "batch: words that do not belong together");
  // A reply is one packet: when there are many failures the texts of the later ones are cut.
  constexpr std::size_t kWhole = 96U << 10U;
  constexpr std::size_t kMost = 160U << 10U;
  constexpr std::size_t kCut = 40;
  std::size_t bytes = 0;
  std::vector<ReplyPacket> failures;
  for (std::size_t i = 0; i < batch->commands.size(); ++i) {
    const Command& words = batch->commands[i];
    if (!words.empty() && words[0] == "batch") return bad(Errc::protocol, "batch within a batch");
    Reply done = command(words, caller_);
    if (done.ok()) continue;
    if (bytes + done.text.size() > kWhole) done.text.resize(std::min(done.text.size(), kCut));
    bytes += done.text.size() + 4 * sizeof(std::uint32_t);
    if (bytes > kMost) return bad(Errc::protocol, "batch: too many commands that fail");
    failures.push_back({static_cast<std::uint32_t>(i), done.status, std::move(done.text)});
    if (!batch->keep_going) break;
  }
  return {0, encode_failures(failures)};
}

Reply Host::debug(Words argv) {
  const auto level = parse_value(Type::s32, argv[0]);
  if (!level.ok()) return bad(level.error().code, level.error().message());
  rtapi::set_log_level(static_cast<rtapi::Level>(from_raw<std::int32_t>(*level)));
  return {};
}

// ---- signals and values -------------------------------------------------------------------------

Reply Host::net(Words argv) { return reply(registry_->net(argv[0], argv.subspan(1))); }

Reply Host::new_signal(Words argv) {
  const Type type = type_from_name(argv[1]);
  if (type == Type::unspecified) {
    return bad(Errc::bad_argument, "Unknown signal type " + quoted(argv[1]) +
                                       "; known are bit, float, s32, u32, s64, u64, port");
  }
  return reply(registry_->new_signal(argv[0], type));
}

Reply Host::delete_signal(Words argv) { return reply(registry_->delete_signal(argv[0])); }
Reply Host::link_pin_signal(Words argv) { return reply(registry_->link(argv[0], argv[1])); }
Reply Host::link_signal_pin(Words argv) { return reply(registry_->link(argv[1], argv[0])); }
Reply Host::link_pins(Words argv) { return reply(registry_->link_pins(argv[0], argv[1])); }
Reply Host::unlink(Words argv) { return reply(registry_->unlink(argv[0])); }
Reply Host::set_item(Words argv) { return reply(registry_->set_item(argv[0], argv[1])); }
Reply Host::set_signal(Words argv) { return reply(registry_->set_signal(argv[0], argv[1])); }

Reply Host::alias(Words argv) {
  const Kind kind = argv[0] == "pin" ? Kind::pin : argv[0] == "param" ? Kind::param : Kind::none;
  if (kind == Kind::none)
    return bad(Errc::bad_argument, "alias: " + quoted(argv[0]) + " is neither pin nor param");
  return reply(registry_->alias(kind, argv[1], argv[2]));
}

Reply Host::alias_later(Words argv) {
  later_aliases_.insert_or_assign(argv[0], argv[1]);
  give_later_aliases();
  return {};
}

void Host::give_later_aliases() {
  // Not found: its component is not loaded yet. Taken: the machine has given that name itself.
  for (const auto& [name, alias] : later_aliases_) (void)registry_->alias(Kind::pin, name, alias);
}

Reply Host::unalias(Words argv) {
  const Kind kind = argv[0] == "pin" ? Kind::pin : argv[0] == "param" ? Kind::param : Kind::none;
  if (kind == Kind::none)
    return bad(Errc::bad_argument, "unalias: " + quoted(argv[0]) + " is neither pin nor param");
  return reply(registry_->unalias(kind, argv[1]));
}

Reply Host::check_invariants(Words /*argv*/) { return reply(registry_->check_invariants()); }

Reply Host::start(Words /*argv*/) {
  registry_->set_running(true);
  return {};
}

Reply Host::stop(Words /*argv*/) {
  registry_->set_running(false);
  return {};
}

Reply Host::lock(Words argv) {
  const std::string what = argv.empty() ? "all" : argv[0];
  if (what == "none")
    registry_->set_lock(lock_none);
  else if (what == "tune")
    registry_->set_lock(lock_tune);
  else if (what == "all")
    registry_->set_lock(lock_all);
  else
    return bad(Errc::bad_argument,
               "Unknown 'lock' type " + quoted(what) + "; known are none, tune, all");
  return {};
}

Reply Host::lock_bits(Words argv) {
  const auto bits = parse_value(Type::u32, argv[0]);
  if (!bits.ok() || from_raw<std::uint32_t>(*bits) > lock_all)
    return bad(Errc::bad_argument, "lock bits " + quoted(argv[0]) + " are not 0 to 255");
  registry_->set_lock(from_raw<std::uint32_t>(*bits));
  return {};
}

Reply Host::unlock(Words argv) {
  const std::string what = argv.empty() ? "all" : argv[0];
  // What `lock tune` has locked is free again; of what `lock all` has, tuning is. It never locks anything.
  const std::uint32_t bits = registry_->root().lock.get();
  if (what == "tune")
    registry_->set_lock((bits & ~static_cast<std::uint32_t>(lock_tune)) != 0 ? bits & lock_tune
                                                                             : lock_none);
  else if (what == "all")
    registry_->set_lock(lock_none);
  else
    return bad(Errc::bad_argument,
               "Unknown 'unlock' type " + quoted(what) + "; known are tune, all");
  return {};
}

Reply Host::timing(Words argv) {
  if (argv[0] == "reset") {
    auto& epoch = registry_->root().timing_epoch;
    epoch.set(epoch.get() + 1);
    return {};
  }
  const auto mode = timing_mode_of(argv[0]);
  if (!mode) {
    return bad(Errc::bad_argument, "Unknown 'timing' word " + quoted(argv[0]) +
                                       "; known are every, sampled, off, reset");
  }
  set_timing_mode(*mode);
  return {};
}

// ---- what drivers look at -----------------------------------------------------------------------

std::vector<ThreadRunner*> Host::threads() const {
  std::vector<ThreadRunner*> out;
  for (const auto& t : threads_) out.push_back(t->runner.get());
  std::stable_sort(out.begin(), out.end(), [](const ThreadRunner* a, const ThreadRunner* b) {
    return a->period_ns() < b->period_ns();
  });
  return out;
}

std::vector<rtapi::Participant*> Host::participants() const {
  std::vector<rtapi::Participant*> out;
  for (const auto& l : loaded_)
    out.insert(out.end(), l->participants.begin(), l->participants.end());
  return out;
}

Host::Thread* Host::find_thread(std::string_view name) {
  for (const auto& t : threads_) {
    if (t->runner->record().name == name) return t.get();
  }
  return nullptr;
}

Host::Loaded* Host::find_loaded(std::string_view name) const {
  const auto folded = [](std::string_view s) {
    std::string out(s);
    std::replace(out.begin(), out.end(), '-', '_');
    return out;
  };
  for (const auto& l : loaded_) {
    if (folded(l->name) == folded(name)) return l.get();
    if (l->c != nullptr && CModules::has_component(*l, name)) return l.get();
  }
  return nullptr;
}

}  // namespace kerf::hal
