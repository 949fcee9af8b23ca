/*
 * hdf5_memory.c - a driver of libhdf5; see hdf5_memory.h
 *
 * Source: "Virtual File Layer", HDF5 documentation; its own driver for files, H5FDsec2.c.
 */
#define H5_USE_110_API

#include "hdf5_memory.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#if H5_VERSION_GE(1, 13, 0)
#include <H5FDdevelop.h>
#endif

enum { DRIVER_VALUE = 511 }; /* of those that are free for experiments */

typedef struct memory_info {
    const unsigned char *bytes;
    size_t size;
    int descriptor, *error;
} memory_info;

typedef struct memory_file {
    H5FD_t base; /* has to be the first */
    memory_info info;
    haddr_t eoa, eof;
} memory_file;

static H5FD_t *driver_open(const char *name, unsigned flags, hid_t access, haddr_t most) {
    const memory_info *info = H5Pget_driver_info(access);
    struct stat about;
    memory_file *f = info ? calloc(1, sizeof *f) : NULL;
    (void)name, (void)flags, (void)most;
    if (!f) return NULL;
    f->info = *info;
    f->eof = info->size;
    if (!info->bytes && fstat(info->descriptor, &about) == 0) f->eof = (haddr_t)about.st_size;
    return &f->base;
}

static herr_t driver_close(H5FD_t *file) {
    free(file);
    return 0;
}

static herr_t driver_query(const H5FD_t *file, unsigned long *flags) {
    (void)file;
    *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
             H5FD_FEAT_AGGREGATE_SMALLDATA;
    return 0;
}

static haddr_t driver_get_eoa(const H5FD_t *file, H5FD_mem_t type) {
    (void)type;
    return ((const memory_file *)file)->eoa;
}

static herr_t driver_set_eoa(H5FD_t *file, H5FD_mem_t type, haddr_t address) {
    (void)type;
    ((memory_file *)file)->eoa = address;
    return 0;
}

static haddr_t driver_get_eof(const H5FD_t *file, H5FD_mem_t type) {
    (void)type;
    return ((const memory_file *)file)->eof;
}

/* Behind the end there are zeros, as libhdf5's own drivers have it. */
static herr_t driver_read(H5FD_t *file, H5FD_mem_t type, hid_t how, haddr_t address, size_t size, void *to) {
    const memory_file *f = (const memory_file *)file;
    (void)type, (void)how;
    const size_t there = address >= f->eof ? 0 : f->eof - address < size ? (size_t)(f->eof - address) : size;
    memset((unsigned char *)to + there, 0, size - there);
    if (f->info.bytes) {
        if (there) memcpy(to, f->info.bytes + address, there);
        return 0;
    }
    return pread(f->info.descriptor, to, there, (off_t)address) == (ssize_t)there ? 0 : -1;
}

/* Returns 0 or errno. */
static int write_all(int descriptor, const unsigned char *from, size_t size, off_t at) {
    while (size) {
        const ssize_t written = pwrite(descriptor, from, size, at);
        if (written <= 0) return written < 0 ? errno : ENOSPC;
        from += written;
        at += written;
        size -= (size_t)written;
    }
    return 0;
}

static herr_t driver_write(H5FD_t *file, H5FD_mem_t type, hid_t how, haddr_t address, size_t size, const void *from) {
    memory_file *f = (memory_file *)file;
    (void)type, (void)how;
    if (f->info.bytes) return -1;
    if (!*f->info.error) *f->info.error = write_all(f->info.descriptor, from, size, (off_t)address);
    if (address + size > f->eof) f->eof = address + size;
    return 0;
}

static herr_t driver_truncate(H5FD_t *file, hid_t how, hbool_t is_closing) {
    memory_file *f = (memory_file *)file;
    (void)how, (void)is_closing;
    if (f->info.bytes || f->eoa == f->eof) return 0;
    if (ftruncate(f->info.descriptor, (off_t)f->eoa) != 0 && !*f->info.error) *f->info.error = errno;
    f->eof = f->eoa;
    return 0;
}

static const H5FD_class_t driver = {
#if H5_VERSION_GE(1, 13, 0)
    .version = H5FD_CLASS_VERSION,
    .value = DRIVER_VALUE,
#endif
    .name = "memory",
    .maxaddr = INT64_MAX,
    .fc_degree = H5F_CLOSE_STRONG,
    .fapl_size = sizeof(memory_info),
    .open = driver_open,
    .close = driver_close,
    .query = driver_query,
    .get_eoa = driver_get_eoa,
    .set_eoa = driver_set_eoa,
    .get_eof = driver_get_eof,
    .read = driver_read,
    .write = driver_write,
    .truncate = driver_truncate,
    .fl_map = H5FD_FLMAP_DICHOTOMY,
};

hid_t hdf5_memory_access(const void *bytes, size_t size, int descriptor, int *error) {
    const memory_info info = {bytes, size, descriptor, error};
    const hid_t registered = H5FDregister(&driver), access = H5Pcreate(H5P_FILE_ACCESS);
    const int is_set = registered >= 0 && access >= 0 && H5Pset_driver(access, registered, &info) >= 0 &&
                       H5Pset_fclose_degree(access, H5F_CLOSE_STRONG) >= 0;
    if (registered >= 0) H5FDunregister(registered); /* the list holds it */
    if (access >= 0 && !is_set) H5Pclose(access);
    return is_set ? access : -1;
}
