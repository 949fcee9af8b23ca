/*
 * seeds.c - writes the seeds of all fuzzers; see seeds.h
 *
 * Usage: make_seeds FOLDER, which receives a folder per target
 */
#include "seeds.h"

#include "../limit_cases.h"

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

static const char *target_of(const char *name) {
    static const char *const endings[][2] = {{".nrrd", "nrrd"},   {".mha", "metaimage"},    {".vtk", "vtk_legacy"},
                                             {".vtu", "vtk_xml"}, {".vti", "vtk_xml"},      {".xyz", "plot3d"},
                                             {".npy", "npy"},     {".pvti", "vtk_parallel"}};
    for (size_t n = 0; n < sizeof endings / sizeof *endings; n++)
        if (strstr(name, endings[n][0])) return endings[n][1];
    return "raw";
}

/* Sizes at their limits, which mutation seldom makes. Plot3D: without a second file. */
static void seeds_limits(const char *kind, const limit_case *cases, size_t count) {
    static const char options[4] = {-1, -1, 4, 0};
    for (size_t n = 0; n < count; n++) {
        char name[64];
        snprintf(name, sizeof name, "%s-%zu", kind, n);
        seed_file(target_of(cases[n].name), name, cases[n].text, strlen(cases[n].text), NULL, 0, options);
    }
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
    seeds_hdf5();
    seeds_grids();
    seeds_limits("size", size_cases, sizeof size_cases / sizeof *size_cases);
    seeds_limits("distance", distance_cases, sizeof distance_cases / sizeof *distance_cases);
    return 0;
}
