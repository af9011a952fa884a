// BlockCache: parsed lines that a loop or a sub runs again.
#include <algorithm>

#include "interp/program.hpp"

namespace kerf::interp {

template <class T>
std::span<const T> BlockCache::copy(std::span<const T> from) {
  if (from.empty()) return {};
  void* const memory = memory_.allocate(from.size_bytes(), alignof(T));
  bytes_ += from.size_bytes();
  T* const to = static_cast<T*>(memory);
  std::uninitialized_copy(from.begin(), from.end(), to);
  return {to, from.size()};
}

ParsedBlock* BlockCache::keep(const ParsedBlock& b) {
  const auto [at, added] = blocks_.try_emplace(b.place.offset, nullptr);
  if (!added) return at->second;
  // A node of the map and its share of the buckets; an estimate is enough for a limit.
  constexpr std::size_t kMapEntry = 48;
  bytes_ += sizeof(ParsedBlock) + kMapEntry;
  auto* const kept =
      ::new (memory_.allocate(sizeof(ParsedBlock), alignof(ParsedBlock))) ParsedBlock(b);
  const auto text = [this](std::string_view from) {
    const auto chars = copy(std::span<const char>(from));
    return std::string_view(chars.data(), chars.size());
  };
  kept->words = copy(b.words);
  kept->assignments = copy(b.assignments);
  kept->ops = copy(b.ops);
  kept->arguments = copy(b.arguments);
  kept->comment_text = text(b.comment_text);
  kept->text = text(b.text);
  kept->cached = true;
  at->second = kept;
  return kept;
}

void BlockCache::clear() {
  blocks_.clear();
  memory_.release();
  bytes_ = 0;
}

}  // namespace kerf::interp
