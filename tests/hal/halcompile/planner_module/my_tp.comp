component my_tp "The frame of a trajectory planner module";
option tpmod;
pin out bit is_module = 1;
license "GPL";
;;
#include "posemath.h"
int tpIsDone(void *tp) { (void)tp; return 1; }
int tpQueueDepth(void *tp) { (void)tp; return 0; }
EXPORT_SYMBOL(tpIsDone);
EXPORT_SYMBOL(tpQueueDepth);
