#include "hal/cmd/instances.hpp"

#include <algorithm>

namespace kerf::hal {

namespace {

/// Words between dots that both names begin with.
std::size_t common_words(std::string_view a, std::string_view b) {
  std::size_t words = 0;
  while (!a.empty() && !b.empty()) {
    const auto ea = std::min(a.find('.'), a.size()), eb = std::min(b.find('.'), b.size());
    if (a.substr(0, ea) != b.substr(0, eb)) break;
    ++words;
    a.remove_prefix(std::min(ea + 1, a.size()));
    b.remove_prefix(std::min(eb + 1, b.size()));
  }
  return words;
}

}  // namespace

Instances::Instances(const std::vector<FunctionInfo>& functions,
                     const std::vector<ThreadInfo>& threads) {
  std::map<std::pair<std::string, std::uint64_t>, std::size_t> index;
  std::map<std::string, std::size_t> of_function;
  for (const auto& f : functions) {
    const auto [it, fresh] = index.emplace(std::pair(f.owner, f.argument), all_.size());
    if (fresh) {
      by_owner_[f.owner].push_back(all_.size());
      all_.push_back({f.owner, {}, {}});
    }
    all_[it->second].functions.push_back(f.name);
    of_function[f.name] = it->second;
  }
  for (const auto& t : threads) {
    std::size_t position = 0;
    for (const auto& f : t.functions) {
      ++position;
      if (const auto it = of_function.find(f); it != of_function.end())
        all_[it->second].runs[t.name].push_back(position);
    }
  }
}

std::optional<std::size_t> Instances::of_pin(const ItemInfo& pin) const {
  const auto owner = by_owner_.find(pin.owner);
  if (owner == by_owner_.end()) return std::nullopt;
  if (owner->second.size() == 1) return owner->second.front();
  std::optional<std::size_t> best;
  std::size_t most = 0;
  for (const std::size_t i : owner->second) {
    for (const auto& f : all_[i].functions) {
      const std::size_t words = common_words(pin.name, f);
      if (words > most) {
        most = words;
        best = i;
      } else if (words == most && best != i) {
        best.reset();
      }
    }
  }
  return most > 0 ? best : std::nullopt;
}

bool Instances::late(const ItemInfo& writer, const ItemInfo& reader) const {
  const auto from = of_pin(writer), to = of_pin(reader);
  if (!from || !to) return false;
  if (*from == *to) return true;
  for (const auto& [thread, w] : all_[*from].runs) {
    const auto r = all_[*to].runs.find(thread);
    if (r != all_[*to].runs.end() && w.front() > r->second.back()) return true;
  }
  return false;
}

}  // namespace kerf::hal
