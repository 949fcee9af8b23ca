/*
 * layer_find.h - the layer that is loaded into this process
 */
#ifndef LAYER_FIND_H
#define LAYER_FIND_H

#include "layer.h"

#include <dlfcn.h>
#include <stdlib.h>

/* NULL where the loader has not loaded it: it is named in OPENCL_LAYERS, and the loader has been called before. */
static inline const layer_functions *layer_find(void) {
    const char *path = getenv("OPENCL_LAYERS");
    void *library = path ? dlopen(path, RTLD_LAZY | RTLD_NOLOAD) : NULL;
    return library ? dlsym(library, "layer_control") : NULL;
}

#endif
