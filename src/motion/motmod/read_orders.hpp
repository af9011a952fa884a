// The words of the intent cell, read in an order in which a stop is never missed. @rt.
#pragma once

#include "motion/core/io.hpp"

namespace kerf::motion {

/// Task publishes an abort first, and only then takes hold away and changes anything else. So the epoch is read last: whoever
/// sees what came behind the abort sees the abort too, and no cycle runs the old path without its hold. `Cell`: IntentCell.
template <class Cell>
void read_orders(const Cell& cell, Orders& orders) noexcept {
  orders.heartbeat = cell.heartbeat.get();
  orders.hold = cell.hold.observe() != 0;
  orders.enable_request = cell.enable.observe();
  orders.enable = orders.enable_request != 0;
  orders.abort_epoch = cell.abort_epoch.observe();
}

}  // namespace kerf::motion
