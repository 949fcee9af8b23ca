/*
 * plain_processor.c - preloaded (LD_PRELOAD), lets PoCL compile for a processor without AVX-512, whatever this one has
 *
 * So do emulators, which know no AVX-512 and tell so; kernels compiled for this processor would not run there. It
 * stands before llvm::sys::getHostCPUFeatures(StringMap<bool> &), by which PoCL learns what there is, and takes back
 * what LLVM has found. Nothing of this needs LLVM's headers: the map is an array of pointers to entries, each a length,
 * the value, then the name (llvm/ADT/StringMap.h, the same since LLVM 3).
 */
#include <dlfcn.h>
#include <link.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FEATURES_OF_HOST _ZN4llvm3sys18getHostCPUFeaturesERNS_9StringMapIbNS_15MallocAllocatorEEE
#define TEXT_OF(name)    #name
#define TEXT(name)       TEXT_OF(name)

typedef struct feature {
    size_t length;
    bool exists; /* then the name, behind the padding */
} feature;

typedef struct feature_map {
    feature **entries; /* NULL: free; the highest addresses: removed */
    unsigned entry_count;
} feature_map;

typedef bool features_function(feature_map *features);

static int library_find(struct dl_phdr_info *object, size_t bytes, void *found) {
    (void)bytes;
    if (strstr(object->dlpi_name, "libLLVM")) *(const char **)found = object->dlpi_name;
    return 0;
}

__attribute__((visibility("default"))) features_function FEATURES_OF_HOST;

bool FEATURES_OF_HOST(feature_map *features) {
    const char *library = NULL;
    dl_iterate_phdr(library_find, &library);
    void *llvm = library ? dlopen(library, RTLD_LAZY | RTLD_NOLOAD) : NULL;
    features_function *of_llvm = NULL;
    if (llvm) *(void **)&of_llvm = dlsym(llvm, TEXT(FEATURES_OF_HOST));
    if (!of_llvm) {
        fprintf(stderr, "plain_processor: no LLVM is loaded\n");
        exit(EXIT_FAILURE);
    }
    bool is_known = of_llvm(features);
    for (unsigned n = 0; n < features->entry_count; n++) {
        feature *f = features->entries[n];
        if (!f || (intptr_t)f < 0) continue;
        if (!strncmp((const char *)(f + 1), "avx512", 6)) f->exists = false;
    }
    return is_known;
}
