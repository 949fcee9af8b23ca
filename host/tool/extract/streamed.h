/*
 * streamed.h - surfaces that do not fit into memory: made window by window (tc_stream), written piece by piece
 *
 * Their files are those that one process with enough memory writes, byte for byte. Of one structured block; what needs
 * the whole mesh at once (--check, --verify, --soup, --drop-degenerate, --preview, formats that are written in one go)
 * is made in memory, or not at all.
 */
#ifndef STREAMED_H
#define STREAMED_H

#include "carried_fields.h"
#include "report.h"
#include "team.h"

/* What a stream is made of: the input with its one block. */
typedef struct stream_input {
    const options *o;
    const dataset *data;
    const scalar *field;
    const block_list *blocks;
    carried_fields *carried;
    team *team; /* that makes the surfaces; NULL: this process by itself */
} stream_input;

/* *may: whether the surfaces are to be streamed, as --stream or --part asks for it, or may have to be, as a mesh of
 * such a grid can be larger than memory. Returns STATUS_USAGE where such an option is given and cannot be followed. */
int stream_may_be_needed(const stream_input *in, int *may);

/* Counts the surfaces and, where --stream is given or one of them does not fit into memory, makes all of them and fills
 * their reports, but for what only a mesh in memory tells; files appear when all are complete. A team makes them in any
 * case; a failure behind the count, of which others do not know, ends it (team.leave). *made is 0 where they fit, and
 * are still to be made. */
int stream_surfaces(const stream_input *in, engine *e, surface_report *surfaces, int *made);

#endif
