/* hdf5_file.c - one dataset of an HDF5 file; see hdf5_file.h */
#define H5_USE_110_API

#include "image/hdf5_file.h"

#include "exit_status.h"
#include "failure.h"
#include "hdf5_memory.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

enum { NAMES_MOST = 12, NAME_BYTES = 200, MESSAGE_BYTES = 160, VOLUME_AXES = 3 };

/* --------------------------------------------------------------------------------------------------------- messages */

/* The innermost error is the first of the walk. */
static herr_t keep_message(unsigned n, const H5E_error2_t *error, void *user) {
    char *message = user;
    if (n == 0 && error->desc) snprintf(message, MESSAGE_BYTES, ": %.150s", error->desc);
    return 0;
}

int hdf5_fail(const hdf5_file *h, const char *what) {
    char message[MESSAGE_BYTES] = "";
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_message, message);
    for (char *at = message; *at; at++)
        if ((unsigned char)*at < ' ') *at = '?';
    return fail(STATUS_INPUT, "%s: %s%s", h->path, what, message);
}

/* ----------------------------------------------------------------------------------------------------------- names */

/* Datasets that may be volumes, of which all are counted, and some listed. */
typedef struct found_names {
    char only[NAME_BYTES], list[NAMES_MOST * NAME_BYTES];
    size_t used;
    int count, listed;
} found_names;

static int dimension_of(hid_t set) {
    const hid_t space = H5Dget_space(set);
    const int dimension = space < 0 ? -1 : H5Sget_simple_extent_ndims(space);
    if (space >= 0) H5Sclose(space);
    return dimension;
}

/* Bytes of 0 and 1: of h5py an enumeration of both, of PyTables a field of 8 bits. */
static int is_boolean(hid_t type) {
    const H5T_class_t kind = H5Tget_class(type);
    unsigned char value[2] = {0};
    if (H5Tget_size(type) != 1 || (kind == H5T_ENUM && H5Tget_nmembers(type) != 2)) return 0;
    for (unsigned n = 0; n < 2 && kind == H5T_ENUM; n++)
        if (H5Tget_member_value(type, n, &value[n]) < 0) return 0;
    return kind == H5T_BITFIELD || (kind == H5T_ENUM && value[0] + value[1] == 1);
}

static int is_number(hid_t set) {
    const hid_t type = H5Dget_type(set);
    const H5T_class_t kind = type < 0 ? H5T_NO_CLASS : H5Tget_class(type);
    const int is = kind == H5T_INTEGER || kind == H5T_FLOAT || kind == H5T_ENUM || (type >= 0 && is_boolean(type));
    if (type >= 0) H5Tclose(type);
    return is;
}

static herr_t note_dataset(hid_t group, const char *name, const H5O_info_t *info, void *user) {
    found_names *f = user;
    if (info->type != H5O_TYPE_DATASET || strlen(name) >= NAME_BYTES) return 0;
    const hid_t set = H5Dopen2(group, name, H5P_DEFAULT);
    const int is_volume = set >= 0 && dimension_of(set) >= VOLUME_AXES && is_number(set);
    if (set >= 0) H5Dclose(set);
    if (!is_volume) return 0;
    if (!f->count++) snprintf(f->only, sizeof f->only, "%s", name);
    if (f->count > NAMES_MOST) return 0;
    f->used += (size_t)snprintf(f->list + f->used, sizeof f->list - f->used, "%s/%.*s", f->used ? ", " : "",
                                NAME_BYTES - 8, name);
    return 0;
}

/* Links are not followed here, neither are those to other files. */
static int find_only(const hdf5_file *h, char name[NAME_BYTES]) {
    found_names f = {.count = 0};
    f.list[0] = '\0';
    if (H5Ovisit(h->file, H5_INDEX_NAME, H5_ITER_NATIVE, note_dataset, &f) < 0)
        return hdf5_fail(h, "its list of datasets cannot be read");
    if (!f.count) return fail(STATUS_INPUT, "%s: holds no dataset of numbers with three axes or more", h->path);
    if (f.count > 1)
        return fail(STATUS_USAGE, "%s: holds %d datasets: name one behind a colon, as in %s:/%s, of: %s%s", h->path,
                    f.count, mapping_is_standard_input(h->path) ? "/dev/stdin" : h->path, f.only, f.list,
                    f.count > NAMES_MOST ? ", ..." : "");
    snprintf(name, NAME_BYTES, "%s", f.only);
    return 0;
}

/* ---------------------------------------------------------------------------------------------------------- dataset */

/* What follows a link to another file asks for. */
static herr_t refuse_file(const char *parent, const char *group, const char *file, const char *object, unsigned *flags,
                          hid_t access, void *user) {
    (void)parent, (void)group, (void)file, (void)object, (void)flags, (void)access;
    *(int *)user = 1;
    return -1;
}

hid_t hdf5_open_group(const hdf5_file *h, const char *name) {
    int is_elsewhere = 0;
    const hid_t access = H5Pcreate(H5P_GROUP_ACCESS);
    const int is_safe = access >= 0 && H5Pset_elink_cb(access, refuse_file, &is_elsewhere) >= 0;
    const hid_t group = is_safe ? H5Gopen2(h->file, name, access) : -1;
    if (access >= 0) H5Pclose(access);
    return group;
}

int hdf5_has(hid_t group, const char *name) { return H5Lexists(group, name, H5P_DEFAULT) > 0; }

static int open_dataset(hdf5_file *h, const char *name) {
    int is_elsewhere = 0;
    const hid_t access = H5Pcreate(H5P_DATASET_ACCESS);
    if (access >= 0 && H5Pset_elink_cb(access, refuse_file, &is_elsewhere) >= 0)
        h->dataset = H5Dopen2(h->file, name, access);
    if (access >= 0) H5Pclose(access);
    if (is_elsewhere) return fail(STATUS_INPUT, "%s: '%.100s' is a link to another file: name that one", h->path, name);
    char what[NAME_BYTES + 40];
    snprintf(what, sizeof what, "has no dataset '%.*s'", NAME_BYTES, name);
    return h->dataset >= 0 ? 0 : hdf5_fail(h, what);
}

static int read_shape(hdf5_file *h) {
    hsize_t sizes[H5S_MAX_RANK];
    const hid_t space = H5Dget_space(h->dataset);
    h->dimension = space < 0 ? -1 : H5Sget_simple_extent_dims(space, sizes, NULL);
    if (space >= 0) H5Sclose(space);
    if (h->dimension < 1 || h->dimension > ARRAY_AXES_MOST)
        return fail(STATUS_INPUT, "%s: its dataset has %d axes; 1 to %d can be read", h->path, h->dimension,
                    ARRAY_AXES_MOST);
    for (int axis = 0; axis < h->dimension; axis++)
        h->shape[axis] = sizes[axis] <= INT64_MAX ? (int64_t)sizes[axis] : 0;
    return 0;
}

static hid_t native_of(int element) {
    switch (element) {
    case TC_U8:
        return H5T_NATIVE_UINT8;
    case TC_I8:
        return H5T_NATIVE_INT8;
    case TC_U16:
        return H5T_NATIVE_UINT16;
    case TC_I16:
        return H5T_NATIVE_INT16;
    case TC_U32:
        return H5T_NATIVE_UINT32;
    case TC_I32:
        return H5T_NATIVE_INT32;
    case TC_F32:
        return H5T_NATIVE_FLOAT;
    case TC_F64:
        return H5T_NATIVE_DOUBLE;
    case ELEMENT_I64:
        return H5T_NATIVE_INT64;
    default:
        return H5T_NATIVE_UINT64;
    }
}

/* The stored type that a number of HDF5 is, in either byte order; -1 where it is none. */
static int element_of_number(hid_t type, int *is_swapped) {
    for (int element = 0; element < ELEMENT_COUNT; element++) {
        const hid_t other = H5Tcopy(native_of(element));
        H5Tset_order(other, __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__ ? H5T_ORDER_BE : H5T_ORDER_LE);
        const int is_native = H5Tequal(type, native_of(element)) > 0, is_other = H5Tequal(type, other) > 0;
        H5Tclose(other);
        *is_swapped = !is_native && is_other;
        if (is_native || is_other) return element;
    }
    return -1;
}

/* Enumerations are the numbers that they name. */
static int element_of(hid_t type, int *is_swapped) {
    *is_swapped = 0;
    if (is_boolean(type)) return TC_U8;
    if (H5Tget_class(type) != H5T_ENUM) return element_of_number(type, is_swapped);
    const hid_t number = H5Tget_super(type);
    const int element = number < 0 ? -1 : element_of_number(number, is_swapped);
    if (number >= 0) H5Tclose(number);
    return element;
}

static int read_type(hdf5_file *h) {
    const hid_t type = H5Dget_type(h->dataset);
    h->element = type < 0 ? -1 : element_of(type, &h->is_swapped);
    if (type >= 0) H5Tclose(type);
    if (h->element >= 0) return 0;
    return fail(STATUS_INPUT,
                "%s: the type of its dataset cannot be read; integers of 8 to 64 bits, numbers of floating point of 32 "
                "and 64, booleans and enumerations can",
                h->path);
}

/* Whether samples lie in the file one behind the other, and where. */
static int read_storage(hdf5_file *h) {
    const hid_t how = H5Dget_create_plist(h->dataset);
    const H5D_layout_t stored = how < 0 ? H5D_LAYOUT_ERROR : H5Pget_layout(how);
    const int others = how < 0 ? 0 : H5Pget_external_count(how);
    if (how >= 0) H5Pclose(how);
    if (stored == H5D_VIRTUAL || others > 0)
        return fail(STATUS_INPUT, "%s: its samples lie in other files: name those", h->path);
    const haddr_t start = stored == H5D_CONTIGUOUS ? H5Dget_offset(h->dataset) : HADDR_UNDEF;
    h->layout = stored;
    h->stored_bytes = H5Dget_storage_size(h->dataset);
    h->start = start != HADDR_UNDEF ? start : 0;
    if (stored == H5D_LAYOUT_ERROR || (stored == H5D_CONTIGUOUS && start == HADDR_UNDEF)) h->stored_bytes = 0;
    return 0;
}

static int check_stored(const hdf5_file *h) {
    if (h->stored_bytes) return 0;
    return fail(STATUS_INPUT, "%s: its dataset was made, but no samples were written", h->path);
}

/* ----------------------------------------------------------------------------------------------------------- world */

int hdf5_read_numbers(hid_t object, const char *name, double *values, int count) {
    double own[9];
    if (H5Aexists(object, name) <= 0) return 0;
    const hid_t attribute = H5Aopen(object, name, H5P_DEFAULT), space = attribute < 0 ? -1 : H5Aget_space(attribute);
    const int is_read =
        space >= 0 && H5Sget_simple_extent_npoints(space) == count && H5Aread(attribute, H5T_NATIVE_DOUBLE, own) >= 0;
    if (is_read) memcpy(values, own, (size_t)count * sizeof *values);
    if (space >= 0) H5Sclose(space);
    if (attribute >= 0) H5Aclose(attribute);
    return is_read;
}

void hdf5_read_text(hid_t object, const char *name, char text[HDF5_TEXT_BYTES]) {
    text[0] = '\0';
    if (H5Aexists(object, name) <= 0) return;
    const hid_t attribute = H5Aopen(object, name, H5P_DEFAULT), type = attribute < 0 ? -1 : H5Aget_type(attribute);
    const hid_t space = attribute < 0 ? -1 : H5Aget_space(attribute);
    const size_t bytes = type < 0 ? 0 : H5Tget_size(type);
    if (type >= 0 && H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0 && bytes < HDF5_TEXT_BYTES &&
        space >= 0 && H5Sget_simple_extent_npoints(space) == 1) {
        memset(text, 0, HDF5_TEXT_BYTES);
        if (H5Aread(attribute, type, text) < 0) text[0] = '\0';
    }
    if (space >= 0) H5Sclose(space);
    if (type >= 0) H5Tclose(type);
    if (attribute >= 0) H5Aclose(attribute);
}

/* The image that VTK has written, by the attributes of its group; the origin is that of index 0, 0, 0 of the extent. */
static void read_world_of_vtk(hdf5_file *h) {
    double spacing[3] = {1, 1, 1}, origin[3] = {0, 0, 0}, extent[6] = {0};
    double direction[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const hid_t group = hdf5_open_group(h, "/VTKHDF");
    if (group < 0) return;
    hdf5_read_numbers(group, "Spacing", spacing, 3);
    hdf5_read_numbers(group, "Origin", origin, 3);
    hdf5_read_numbers(group, "Direction", direction, 9);
    hdf5_read_numbers(group, "WholeExtent", extent, 6);
    H5Gclose(group);
    for (int row = 0; row < 3; row++) {
        h->matrix[row][3] = origin[row];
        for (int axis = 0; axis < 3; axis++) {
            h->matrix[row][axis] = direction[3 * row + axis] * spacing[axis];
            h->matrix[row][3] += h->matrix[row][axis] * extent[2 * axis];
        }
    }
}

/* As Fiji and ilastik write it, z, y, x; or VTK's. */
static int read_world(hdf5_file *h) {
    double sizes[3] = {1, 1, 1};
    char name[NAME_BYTES] = "";
    H5Iget_name(h->dataset, name, sizeof name);
    h->is_in_um = hdf5_read_numbers(h->dataset, "element_size_um", sizes, 3);
    for (int axis = 0; axis < 3; axis++) h->matrix[axis][axis] = sizes[2 - axis] > 0 ? sizes[2 - axis] : 1;
    if (strncmp(name, "/VTKHDF/CellData/", 17) == 0)
        return fail(STATUS_INPUT, "%s: '%s' has values of cells; of VTKHDF, those of the points of images are read",
                    h->path, name);
    if (strncmp(name, "/VTKHDF/PointData/", 18) == 0) read_world_of_vtk(h);
    return 0;
}

int hdf5_open_file(hdf5_file *h, const char *path, const mapping *file) {
    *h = (hdf5_file){.path = path, .file = -1, .dataset = -1};
    H5Eget_auto2(H5E_DEFAULT, &h->report, &h->report_data);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    const hid_t access = hdf5_memory_access(file->bytes, file->size, -1, NULL);
    if (access >= 0) h->file = H5Fopen(path, H5F_ACC_RDONLY, access);
    if (access >= 0) H5Pclose(access);
    return h->file < 0 ? hdf5_fail(h, "cannot be opened as HDF5; it is damaged or cut") : 0;
}

int hdf5_open_array(hdf5_file *h, const char *name) {
    if (h->dataset >= 0) H5Dclose(h->dataset);
    h->dataset = -1;
    int status = open_dataset(h, name);
    if (!status) status = read_shape(h);
    if (!status) status = read_type(h);
    return status ? status : read_storage(h);
}

int hdf5_open(hdf5_file *h, const char *path, const mapping *file, const char *name) {
    char only[NAME_BYTES];
    int status = hdf5_open_file(h, path, file);
    if (!status && !name && !(status = find_only(h, only))) name = only;
    if (!status) status = hdf5_open_array(h, name);
    if (!status) status = check_stored(h);
    return status ? status : read_world(h);
}

int hdf5_load(const hdf5_file *h, void *to) {
    if (h->layout == H5D_CHUNKED) return hdf5_load_chunks(h, to);
    const hid_t type = H5Dget_type(h->dataset);
    const int is_read = type >= 0 && H5Dread(h->dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, to) >= 0;
    const int status = is_read ? 0 : hdf5_fail(h, "its samples cannot be read; it is damaged or cut");
    if (type >= 0) H5Tclose(type);
    return status;
}

void hdf5_close(hdf5_file *h) {
    if (h->file >= 0) H5Fclose(h->file);
    H5Eclear2(H5E_DEFAULT);
    H5Eset_auto2(H5E_DEFAULT, h->report, h->report_data);
    h->file = h->dataset = -1;
}
