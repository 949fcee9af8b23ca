/*
 * seeds.c - writes the seeds of all fuzzers; see seeds.h
 *
 * Usage: make_seeds FOLDER, which receives a folder per target
 */
#include "seeds.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const char *folder;

void seed_write(const char *target, const char *name, const void *data, size_t size) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, target);
    mkdir(path, 0777);
    snprintf(path, sizeof path, "%s/%s/%s", folder, target, name);
    FILE *file = fopen(path, "wb");
    if (!file || (size && fwrite(data, size, 1, file) != 1) || fclose(file)) {
        fprintf(stderr, "cannot write %s\n", path);
        exit(1);
    }
}

void seed_file(const char *target, const char *name, const void *data, size_t size, const void *second,
               size_t second_size, const char options[4]) {
    static const char marker[] = "\n=FILE=\n";
    char *all = malloc(size + second_size + sizeof marker + 4), *at = all;
    if (size) at = mempcpy(at, data, size);
    if (second) at = mempcpy(mempcpy(at, marker, sizeof marker - 1), second, second_size);
    at = mempcpy(at, options, 4);
    seed_write(target, name, all, (size_t)(at - all));
    free(all);
}

int main(int argc, char **argv) {
    if (argc != 2) {
        fprintf(stderr, "usage: make_seeds FOLDER\n");
        return 2;
    }
    folder = argv[1];
    mkdir(folder, 0777);
    seeds_images();
    seeds_vtk();
    seeds_plot3d();
    seeds_grids();
    return 0;
}
