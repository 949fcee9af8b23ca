/* host_memory.h - how much memory the process may still take */
#ifndef HOST_MEMORY_H
#define HOST_MEMORY_H

#include <stdint.h>

/* Bytes: what the system has available, or less where a control group or a limit of the process (ulimit -d, -v) says
 * so. UINT64_MAX where nothing tells. */
uint64_t host_memory_available(void);

/* Of that the part of control groups, version 2: what the process's group, and those around it, may still use.
 * membership: the file that names the group, /proc/self/cgroup; hierarchy: the folder that groups lie in. */
uint64_t group_memory_available(const char *membership, const char *hierarchy);

#endif
