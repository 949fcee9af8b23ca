/* input_summary.h - what was read, in short: sizes, and the field that was chosen */
#ifndef INPUT_SUMMARY_H
#define INPUT_SUMMARY_H

#include "command_line/options.h"
#include "field/select.h"
#include "input/blocks.h"

typedef struct input_summary {
    const char *path;
    const dataset_block *grid; /* of an input that is one structured block, else NULL */
    int block_count;
    const char *field; /* "" where it has no name */
    tc_type type;
    uint64_t point_count, cell_count, tetrahedron_count; /* cells: of three dimensions */
} input_summary;

/* Valid as long as the dataset and the field are. */
input_summary input_summarize(const options *o, const dataset *d, const scalar *field, const block_list *blocks);

/* The summary and which part of the grid was taken (region_report.h), a line each. */
void input_summary_text(const input_summary *s);

#endif
