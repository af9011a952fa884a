// ProfileReading: a lathe cycle (G70-G72) whose profile is being read from its sub. The lines of the sub run through
// Core::profile_step(), which takes their moves and leaves everything else alone; when the sub is done the cycle runs.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "interp/core.hpp"
#include "interp/lathe/profile.hpp"

namespace kerf::interp {

struct ProfileReading {
  int code{0};        ///< of the cycle, times ten
  Block block;        ///< of the cycle; its `source` is gone
  SourceLine source;  ///< of the cycle's line; texts are kept below
  std::string file, text;
  std::size_t level{0};  ///< frames outside the sub
  Pose start;            ///< where the cycle begins (X and Z words)
  lathe::Point at;       ///< end of the last move; s is Z, h is X
  int motion{10};        ///< G0-G3 of the sub so far, times ten
  lathe::Path moves;     ///< the first one leads from the start to the profile

  /// G70 under cutter compensation, which takes one move a block: what is still to do, in program coordinates.
  struct Step {
    bool is_arc{false}, traverse{false};
    Arc arc;  ///< of a straight move only its end
  };
  std::vector<Step> steps;
  std::size_t next{0};
};

}  // namespace kerf::interp
