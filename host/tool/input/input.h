/* input.h - a command's inputs: one file, or the two of Plot3D, read as a dataset; the field that the options choose */
#ifndef INPUT_H
#define INPUT_H

#include "command_line/options.h"
#include "dataset/dataset.h"
#include "dataset/request.h"
#include "field/select.h"

/* All that the options say about the inputs; refuses none or too many, and --dims without --type. */
int input_request(const options *o, read_request *request);

/* Reads the inputs; notices of the reader become notices of the run. *d is to be released in any case. */
int input_read(const read_request *request, dataset *d);

/* Chooses the field by --field, --component and --nodata, with notices where it had to be averaged,
 * and where --nodata is nowhere in it; leaves out what --mask does. */
int input_select(const read_request *request, dataset *d, scalar *out);

/* Gives all fields the values of their block's part, for what is told of them; to be called behind input_select, which
 * wants the values of cells around a part. */
int input_take_parts(dataset *d);

/* The field's samples, an array per block, for statistics: of points that some cell of three dimensions uses, or of all
 * where no block has such a cell; from malloc, NULL with its failure's text without memory. */
struct sample_array *input_samples(const dataset *d, const scalar *field);

/* The notice that 64-bit integers of a field that is used were rounded to doubles. */
void input_tell_rounded(const char *name);

/* The notice that a field of cells was averaged. */
void input_tell_average(const dataset *d, const char *name);

/* STATUS_USAGE where path, the output that the option names, is one of the inputs or a file that the dataset was read
 * from: it must not replace what it is made from. d is NULL before the inputs are read. */
int input_overwrite_check(const options *o, const dataset *d, const char *option, const char *path);

/* *has: whether input_select can succeed: a field is named, or there is just one and nothing to choose in it. For
 * commands that can do without a field. Returns 0 or STATUS_FAILED. */
int input_has_choice(const read_request *request, const dataset *d, int *has);

/* The exit status of a failure of the library with the input's grid: the file is to blame, or of raw input the options.
 */
int input_status(const options *o, tc_status status);

#endif
