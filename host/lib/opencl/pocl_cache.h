/* pocl_cache.h - PoCL's own cache of kernels, without which it has no device */
#ifndef POCL_CACHE_H
#define POCL_CACHE_H

#include <stdbool.h>
#include <stddef.h>

/* Whether PoCL could neither write its cache folder nor make it; folder then has its name, cut where it is longer. */
bool pocl_cache_is_locked(char *folder, size_t bytes);

#endif
