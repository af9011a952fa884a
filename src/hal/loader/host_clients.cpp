// Host: components and memory of other processes. What they send is checked here: they may be broken, or another build.
#include <charconv>

#include "hal/core/value_access.hpp"
#include "hal/core/value_text.hpp"
#include "hal/loader/host.hpp"

namespace kerf::hal {

using rtapi::Errc;
using rtapi::fail;
using rtapi::Result;
using rtapi::Status;

namespace {

/// Mappings begin at a page, and the segment ends below the kernel's half of the address space.
constexpr std::uint64_t kPage = 4096;
constexpr std::uint64_t kHighestBase = std::uint64_t{1} << 47U;

std::string quoted(std::string_view s) { return "'" + std::string(s) + "'"; }

Reply bad(Errc code, std::string text) { return {static_cast<int>(code), std::move(text)}; }
Reply bad(const rtapi::Error& error) { return bad(error.code, error.message()); }

/// A decimal number, all of the text.
Result<std::uint64_t> number(std::string_view what, std::string_view text) {
  std::uint64_t value = 0;
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, value);
  if (parsed.ec != std::errc() || parsed.ptr != end) {
    return fail(Errc::bad_argument,
                std::string(what) + " " + quoted(text) + " is not a decimal number");
  }
  return value;
}

}  // namespace

// ---- components ---------------------------------------------------------------------------------

Host::Process& Host::own_process() {
  const auto it = processes_.find(caller_.process);
  if (it != processes_.end()) return it->second;
  return processes_.emplace(caller_.process, Process{registry_->add_holder(), 0, {}, {}})
      .first->second;
}

Reply Host::component_new(Words argv) {
  std::uint64_t base = 0;
  if (argv.size() > 1) {
    const auto given = number("address", argv[1]);
    if (!given.ok()) return bad(given.error());
    base = *given;
    if (base == 0 || base % kPage != 0 || base >= kHighestBase) {
      return bad(Errc::bad_argument, "address " + argv[1] + " cannot be that of a mapping");
    }
  }
  auto made = registry_->add_component(argv[0], ComponentKind::user, caller_.pid);
  if (!made.ok()) {
    std::string text = made.error().message();
    if (made.error().code == Errc::exists) text = "duplicate component name " + quoted(argv[0]);
    return bad(made.error().code, text);
  }
  (void)own_process();
  user_components_[argv[0]] = {*made, caller_.client, base};
  return {0, std::to_string((*made)->id)};
}

Result<Host::UserComponent*> Host::own_component(const std::string& name) {
  const auto it = user_components_.find(name);
  if (it == user_components_.end())
    return fail(Errc::not_found, "component " + quoted(name) + " not found");
  if (it->second.client != caller_.client) {
    return fail(Errc::permission, "component " + quoted(name) + " belongs to another client");
  }
  return &it->second;
}

Result<std::byte*> Host::own_place(const std::string& text, std::size_t bytes) {
  KERF_TRY(const std::uint64_t offset, number("place", text));
  const auto& memory = own_process().memory;
  auto it = memory.upper_bound(offset);
  // The piece that begins at or before it must reach beyond its end.
  if (it == memory.begin() || offset - std::prev(it)->first >= std::prev(it)->second ||
      std::prev(it)->second - (offset - std::prev(it)->first) < bytes) {
    return fail(Errc::permission, "place " + text + " is not in memory that this program has");
  }
  if (offset % bytes != 0) {
    return fail(Errc::bad_argument,
                "place " + text + " is not aligned to " + std::to_string(bytes) + " bytes");
  }
  return segment().at<std::byte>(offset);
}

Reply Host::item_new(Words argv, bool pin) {
  auto owner = own_component(argv[0]);
  if (!owner.ok()) return bad(owner.error());
  if ((*owner)->record->ready != 0) {
    return bad(Errc::busy,
               "component " + quoted(argv[0]) + " is ready: no more pins or parameters");
  }
  ItemSpec spec;
  spec.name = argv[1];
  spec.type = type_from_name(argv[2]);
  spec.dir = dir_from_name(argv[3]);
  const bool is_pin_dir = spec.dir == Dir::in || spec.dir == Dir::out || spec.dir == Dir::io;
  if (spec.type == Type::unspecified || spec.dir == Dir::unspecified || is_pin_dir != pin) {
    return bad(Errc::bad_argument,
               "bad type or direction for " + quoted(argv[1]) + ": " + argv[2] + " " + argv[3]);
  }
  if (argv.size() > 4 && !argv[4].empty()) {
    auto value = parse_value(spec.type, argv[4]);
    if (!value.ok()) return bad(value.error());
    spec.initial = *value;
  }
  if (argv.size() > 5) {
    if ((*owner)->base == 0) {
      return bad(Errc::bad_argument, "component " + quoted(argv[0]) +
                                         " has not told where it maps the segment (comp-new NAME "
                                         "BASE)");
    }
    spec.owner_base = (*owner)->base;
    const auto place = own_place(argv[5], pin ? sizeof *spec.cell : value_bytes(spec.type));
    if (!place.ok()) return bad(place.error());
    if (pin)
      spec.cell = reinterpret_cast<std::uint64_t*>(*place);
    else
      spec.native = *place;
  }
  auto& record = *(*owner)->record;
  auto made = pin ? registry_->add_pin(record, spec) : registry_->add_param(record, spec);
  if (!made.ok()) return bad(made.error());
  return {0, std::to_string((*made)->link)};
}

Reply Host::pin_new(Words argv) { return item_new(argv, true); }
Reply Host::param_new(Words argv) { return item_new(argv, false); }

Reply Host::component_ready(Words argv) {
  auto own = own_component(argv[0]);
  if (!own.ok()) return bad(own.error());
  if ((*own)->record->ready != 0)
    return bad(Errc::busy, "Component " + quoted(argv[0]) + " already ready");
  registry_->set_ready(*(*own)->record);
  return {};
}

Reply Host::component_unready(Words argv) {
  auto own = own_component(argv[0]);
  if (!own.ok()) return bad(own.error());
  registry_->set_unready(*(*own)->record);
  return {};
}

Reply Host::component_exit(Words argv) {
  auto own = own_component(argv[0]);
  if (!own.ok()) return bad(own.error());
  registry_->remove_component(*(*own)->record);
  user_components_.erase(argv[0]);
  return {};
}

void Host::client_gone(std::uint64_t client) {
  for (auto it = user_components_.begin(); it != user_components_.end();) {
    if (it->second.client != client) {
      ++it;
      continue;
    }
    registry_->remove_component(*it->second.record);
    it = user_components_.erase(it);
  }
  registry_->reclaim();
}

// ---- memory -------------------------------------------------------------------------------------

Reply Host::memory_new(Words argv) {
  const auto bytes = number("size", argv[0]);
  if (!bytes.ok()) return bad(bytes.error());
  if (*bytes == 0 || *bytes > segment().header().size) {
    return bad(Errc::bad_argument, "size " + argv[0] + " is not between 1 and " +
                                       std::to_string(segment().header().size));
  }
  const auto made = registry_->allocate_memory(*bytes, Registry::Region::shared);
  if (!made.ok()) return bad(made.error());
  const Offset offset = segment().offset_of(*made);
  own_process().memory[offset] = *bytes;
  return {0, std::to_string(offset)};
}

Reply Host::named_memory_new(Words argv) {
  const std::string& name = argv[0];
  const auto bytes = number("size", argv[1]);
  if (!bytes.ok()) return bad(bytes.error());
  const auto abi = number("abi", argv[2]);
  if (!abi.ok()) return bad(abi.error());
  if (*bytes == 0 || *bytes > segment().header().size) {
    return bad(Errc::bad_argument, "size " + argv[1] + " is not between 1 and " +
                                       std::to_string(segment().header().size));
  }
  MemoryRecord* record = registry_->find_memory(name);
  const auto known = named_.find(name);
  if (record != nullptr && (record->bytes != *bytes || record->abi != *abi)) {
    return bad(Errc::exists, "memory " + quoted(name) + " is there already, with " +
                                 std::to_string(record->bytes) + " bytes and abi " +
                                 std::to_string(record->abi));
  }
  Process& process = own_process();
  if (record == nullptr) {
    auto made = registry_->add_memory(name, *bytes, *abi);
    if (!made.ok()) return bad(made.error());
    record = *made;
    named_[name] = {record, 1};
    ++process.named[name];
  } else if (known != named_.end()) {
    ++known->second.users;
    ++process.named[name];
  }  // else a realtime component's, which ends with that
  return {0, std::to_string(record->memory)};
}

void Host::drop_named(const std::string& name, int times) {
  const auto it = named_.find(name);
  if (it == named_.end()) return;
  it->second.users -= times;
  if (it->second.users > 0) return;
  registry_->remove_memory(*it->second.record);
  named_.erase(it);
}

Reply Host::named_memory_drop(Words argv) {
  Process& process = own_process();
  const auto it = process.named.find(argv[0]);
  if (it == process.named.end()) {
    return bad(Errc::not_found, "this program has no memory " + quoted(argv[0]));
  }
  if (--it->second == 0) process.named.erase(it);
  drop_named(argv[0], 1);
  return {};
}

Reply Host::hold_values(Words /*argv*/) {
  Process& process = own_process();
  if (process.value_holder == 0) process.value_holder = registry_->add_holder(Holds::everything);
  return {};
}

void Host::process_gone(std::uint64_t number) {
  const auto it = processes_.find(number);
  if (it == processes_.end()) return;
  const Process process = std::move(it->second);
  processes_.erase(it);
  for (const auto& [name, times] : process.named) drop_named(name, times);
  for (const auto& [offset, bytes] : process.memory)
    registry_->free_memory(segment().at<std::byte>(offset));
  registry_->remove_holder(process.holder);
  if (process.value_holder != 0) registry_->remove_holder(process.value_holder);
  registry_->reclaim();
}

}  // namespace kerf::hal
