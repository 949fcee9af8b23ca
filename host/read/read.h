/* read.h - reads a file of any format */
#ifndef READ_H
#define READ_H

#include "dataset/dataset.h"
#include "dataset/request.h"

/* Reads the file, or the two files, of the request in the format that its content, else its ending, tells; raw where
 * request->dims are given. Returns 0 and a dataset to be released, or an exit status (exit_status.h) with its message
 * (failure.h), *out zeroed. */
int dataset_read(const read_request *request, dataset *out);

#endif
