/* team_files.h - the files of surfaces that a team makes (team.h), and what its members know of them together */
#ifndef TEAM_FILES_H
#define TEAM_FILES_H

#include "output_group.h"
#include "report.h"
#include "team.h"

/* A surface as a member sees it. */
typedef struct team_surface {
    uint64_t first_vertex, first_triangle; /* of its own in the whole mesh */
    output whole;                          /* of the first member: the file that all write */
    output_shared shared;
    int is_open;
} team_surface;

/* Counts in the reports become those of all members. */
void team_surfaces_count(team *t, surface_report *reports, team_surface *surfaces, size_t count);

/* Opens the file of that name, NULL where this member has no memory for it; the same status on all members. */
int team_surface_open(team *t, const char *path, team_surface *s);

/* Closes the files that are open: complete, they wait in the group of the first member. */
int team_surfaces_close(team *t, team_surface *surfaces, size_t count, output_group *group);

/* After a failure that all know of, in its place: removes those files. */
void team_surfaces_discard(const team *t, team_surface *surfaces, size_t count);

/* Bounds, times and pieces in the reports become those of all members. */
void team_surfaces_report(team *t, surface_report *reports, size_t count);

#endif
