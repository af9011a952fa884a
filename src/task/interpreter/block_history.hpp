// BlockHistory: the state of the interpreter after each block that is not executed yet, so that after a stop it can be put
// back to where the machine stands.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>

#include "interp/modal.hpp"
#include "motion/api/path_items.hpp"
#include "task/interpreter/canon_to_path.hpp"

namespace kerf::task {

inline constexpr rtapi::Pose kNowhere{1e99, 1e99, 1e99, 1e99, 1e99, 1e99, 1e99, 1e99, 1e99};

/// One block, or several blocks in a row that asked nothing of anybody.
struct BlockRecord {
  motion::SourceTag tag;
  std::uint64_t first_seq{0}, last_seq{0};  ///< its items in motion's queue, 0: none (yet)
  int pending{0};                           ///< its items that are neither queued nor done
  bool has_items{false};
  interp::ModalState modal;  ///< after the block
  CanonState canon;
  /// Where its moves may lead (machine coordinates); low is above high in an axis without any.
  rtapi::Pose low{kNowhere}, high{kNowhere * -1};
  [[nodiscard]] bool moves() const {
    for (std::size_t a = 0; a < rtapi::kAxes; ++a)
      if (low[a] <= high[a]) return true;
    return false;
  }
  bool machine_place{false};  ///< names or notes a place in machine coordinates
  /// M6 that is not done: until it is, the length offset is still that of the tool before.
  bool tool_awaited{false};
  rtapi::Pose offset_before;
  std::int32_t offset_code_before{490};
};

/// The oldest record is the block that the machine executes (or executed last); the newest was read last.
class BlockHistory {
 public:
  /// Forgets all and begins at a machine at rest.
  void reset(const interp::ModalState& modal, const CanonState& canon) {
    records_.clear();
    BlockRecord record;
    record.modal = modal;
    record.canon = canon;
    records_.push_back(record);
    moved_ = 0;
  }
  void add(const BlockRecord& record) {
    // Blocks that ask nothing (loops, expressions) would fill the memory with states nobody can stop at.
    if (!record.has_items && !records_.back().has_items && records_.size() > 1) records_.pop_back();
    records_.push_back(record);
  }
  void queued(std::uint64_t tag_id, std::uint64_t seq) {
    if (BlockRecord* r = find(tag_id); r != nullptr) {
      if (r->first_seq == 0) r->first_seq = seq;
      r->last_seq = seq;
      --r->pending;
    }
  }
  /// A barrier's marker: belongs to the block, but the item itself is still pending.
  void marked(std::uint64_t tag_id, std::uint64_t seq) {
    if (BlockRecord* r = find(tag_id); r != nullptr) {
      if (r->first_seq == 0) r->first_seq = seq;
      r->last_seq = seq;
    }
  }
  void done(std::uint64_t tag_id) {
    if (BlockRecord* r = find(tag_id); r != nullptr) --r->pending;
  }
  void tool_changed(std::uint64_t tag_id) {
    if (BlockRecord* r = find(tag_id); r != nullptr) r->tool_awaited = false;
  }
  /// Drops what is behind the machine. `started`: the newest sequence number that motion has begun.
  void advance(std::uint64_t executed, std::uint64_t started) {
    while (records_.size() > 1) {
      const BlockRecord& next = records_[1];
      const bool here_complete = records_[0].pending <= 0 && records_[0].last_seq <= executed;
      const bool begun = next.first_seq != 0 ? next.first_seq <= std::max(started, executed)
                                             : here_complete && next.pending <= 0;
      if (!begun) return;
      records_.pop_front();
      if (records_.front().moves()) moved_ = records_.front().tag.id;
    }
  }
  /// After a stop: the block of this tag is where the machine stands, unless it is behind already.
  const BlockRecord& stopped_at(std::uint64_t tag_id) {
    while (records_.size() > 1 && records_[1].tag.id <= tag_id) records_.pop_front();
    return records_.front();
  }
  template <class F>
  void each(F&& f) {
    for (BlockRecord& record : records_) f(record);
  }
  [[nodiscard]] const BlockRecord& present() const { return records_.front(); }
  /// Id of the newest block that the machine has begun and that moves it; 0: none since reset().
  [[nodiscard]] std::uint64_t moved() const { return moved_; }
  [[nodiscard]] std::size_t size() const { return records_.size(); }

 private:
  BlockRecord* find(std::uint64_t tag_id) {
    const auto at =
        std::lower_bound(records_.begin(), records_.end(), tag_id,
                         [](const BlockRecord& r, std::uint64_t id) { return r.tag.id < id; });
    return at != records_.end() && at->tag.id == tag_id ? &*at : nullptr;
  }
  std::deque<BlockRecord> records_;
  std::uint64_t moved_{0};
};

}  // namespace kerf::task
