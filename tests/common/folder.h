/*
 * folder.h - a folder of the test's own, below TMPDIR or /tmp, and its removal with all that is in it
 */
#ifndef FOLDER_H
#define FOLDER_H

#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>

static char folder[256];

static inline void folder_make(const char *name) {
    const char *parent = getenv("TMPDIR");
    int length = snprintf(folder, sizeof folder, "%s/%s-XXXXXX", parent ? parent : "/tmp", name);
    if ((size_t)length >= sizeof folder || !mkdtemp(folder)) {
        printf("cannot make %s\n", folder);
        exit(EXIT_FAILURE);
    }
}

static inline int entry_remove(const char *path, const struct stat *about, int kind, struct FTW *at) {
    (void)about;
    (void)kind;
    (void)at;
    return remove(path);
}

static inline void folder_remove(void) { nftw(folder, entry_remove, 8, FTW_DEPTH | FTW_PHYS); }

#endif
