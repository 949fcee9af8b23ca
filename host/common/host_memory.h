/* host_memory.h - how much memory the process may still take */
#ifndef HOST_MEMORY_H
#define HOST_MEMORY_H

#include <stdint.h>

/* Bytes: what the system has available, or less where a control group or a limit of the process (ulimit -d, -v) says
 * so. UINT64_MAX where nothing tells. */
uint64_t host_memory_available(void);

#endif
