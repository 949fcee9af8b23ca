/*
 * hdf5_memory.h - libhdf5 on what is no file of a name: bytes in memory, which are read, or a descriptor, which is
 * written
 *
 * So files are read that are mapped, came through a pipe or were unpacked.
 */
#ifndef HDF5_MEMORY_H
#define HDF5_MEMORY_H

#include <hdf5.h>
#include <stddef.h>

/* A file access property list for a file of these bytes, which have to outlive it, or, where bytes is NULL, of what the
 * descriptor stands for. *error is set to the errno of writing that failed, of which libhdf5 hears nothing: it crashes
 * at the program's end where a file cannot be closed. To be closed by H5Pclose; below 0 where libhdf5 fails. The name
 * of the file is of no matter. */
hid_t hdf5_memory_access(const void *bytes, size_t size, int descriptor, int *error);

#endif
