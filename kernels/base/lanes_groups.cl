/*
 * lanes_groups.cl - bit-sliced code where the work-items of a group share bricks: a row at a time
 */
#ifndef LANES_GROUPS_CL
#define LANES_GROUPS_CL

#include "common.cl"

#define LANES 1
typedef ulong lanes;

#define group_barrier() barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE)

/* No prefetch: while a work-item waits for memory, others of its group run. */
#ifndef line_prefetch
#define line_prefetch(address) ((void)(address))
#endif

#define LANE_NUMBERS            0ul
#define lanes_select(condition) ((condition) ? ~0ul : 0ul) /* all bits or none */
#define lanes_popcount(x)       popcount(x)
#define lanes_any(x)            (x)
#define lanes_sum(x)            (x)

/* For normals: axes that are computed at once. One after another needs fewer registers. */
#define AXES_AT_ONCE 1

#endif
