/*
 * planes_cut.h - planes of a grid shared out among the members of a team, or among parts: whole layers of four, in
 * order
 *
 * What is shared out never changes a byte of the file, but who waits for whom.
 */
#ifndef PLANES_CUT_H
#define PLANES_CUT_H

#include "command_line/options.h"
#include "team.h"
#include "tetracubes.h"

/* 0, or STATUS_USAGE where --cut cannot be followed: nz planes, count members of a team or parts. */
int planes_cut_check(const options *o, const team *t, int64_t nz, int64_t count);

/* The planes of member or part `number`: those from planes[0] to before planes[1]. begins: where members 1, 2, ...
 * begin, as planes_cut_by_cost finds it; NULL: where --cut says, else evenly. */
void planes_cut_of(const options *o, const int64_t *begins, int64_t nz, int64_t number, int64_t count,
                   int64_t planes[2]);

/* All members count the surfaces of `how` once, a chunk of layers at a time, and learn where to cut so that each has as
 * much to do: a layer's cost is the bytes of its samples, which are read, and twice those of its meshes, which are made
 * and written. *begins: team.size - 1 planes, from malloc. Where a call of the library fails, others wait in vain: it
 * has to be called again, or the team left. */
tc_status planes_cut_by_cost(team *t, tc_context *context, const tc_stream_options *how, int64_t **begins);

#endif
