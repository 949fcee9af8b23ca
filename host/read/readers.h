/* readers.h - one function per format; each is given the mapped file and fills a zeroed volume but for its release */
#ifndef READERS_H
#define READERS_H

#include "mapping.h"
#include "volume.h"

int raw_read(const read_request *request, const mapping *file, volume *out);
int nrrd_read(const read_request *request, const mapping *file, volume *out);
int metaimage_read(const read_request *request, const mapping *file, volume *out);
int nifti_read(const read_request *request, const mapping *file, volume *out);

#endif
