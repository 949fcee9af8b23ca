/*
 * test_read_data.c - published volume files, and files made to break readers
 *
 * They are found through the environment variable TETRACUBES_DATA; where it is unset, this test says so and skips
 * (status 77).
 */
#include "read_files.h"

enum { SKIPPED = 77 };

typedef struct data_case {
    const char *name;
    int64_t dims[3];
    tc_type type;
    double low, high, spacing[3]; /* lengths of the matrix's columns */
    const char *space;
    int component; /* -1: none */
} data_case;

static const data_case cases[] = {
    {"uniform/neghip.nrrd", {66, 66, 66}, TC_U8, 0, 255, {1, 1, 1}, "", -1},
    {"uniform/bolt.nrrd", {70, 123, 66}, TC_U8, 0, 255, {1, 1, 1}, "", -1},
    {"uniform/embryo.nrrd", {256, 256, 256}, TC_U8, 0, 197, {1, 1, 1}, "", -1},
    {"uniform/headsq/quarter.nhdr", {64, 64, 93}, TC_I16, 0, 3926, {3.2, 3.2, 1.5}, "3D-left-handed", -1},
    {"uniform/HeadMRVolume.mhd", {48, 62, 42}, TC_U8, 0, 255, {4, 4, 4}, "", -1},
    {"uniform/frogtissue.mhd", {500, 470, 136}, TC_U8, 0, 29, {1, 1, 1.5}, "", -1},
    {"uniform/avg152T1_RL_nifti.nii.gz", {91, 109, 91}, TC_U8, 0, 255, {2, 2, 2}, "mni152", -1},
    {"uniform/nifti_types/27_uint8.nii", {3, 3, 3}, TC_U8, 0, 26, {1, 1, 1}, "aligned", -1},
    {"uniform/nifti_types/27_int8.nii", {3, 3, 3}, TC_I8, 0, 26, {1, 1, 1}, "aligned", -1},
    {"uniform/nifti_types/27_uint16.nii", {3, 3, 3}, TC_U16, 0, 26, {1, 1, 1}, "aligned", -1},
    {"uniform/nifti_types/27_int16.nii", {3, 3, 3}, TC_I16, 0, 26, {1, 1, 1}, "aligned", -1},
    {"uniform/nifti_types/27_uint32.nii", {3, 3, 3}, TC_U32, 0, 26, {1, 1, 1}, "aligned", -1},
    {"uniform/nifti_types/27_int32.nii", {3, 3, 3}, TC_I32, 0, 26, {1, 1, 1}, "aligned", -1},
    {"uniform/nifti_types/27_uint64.nii", {3, 3, 3}, TC_F64, 0, 26, {1, 1, 1}, "aligned", -1},
    {"uniform/nifti_types/27_int64.nii", {3, 3, 3}, TC_F64, 0, 26, {1, 1, 1}, "aligned", -1},
    {"uniform/nifti_types/27_float32.nii", {3, 3, 3}, TC_F32, 0, 26, {1, 1, 1}, "aligned", -1},
    {"uniform/nifti_types/27_float64.nii", {3, 3, 3}, TC_F64, 0, 26, {1, 1, 1}, "aligned", -1},
    {"uniform/nifti_types/3D.nii", {3, 3, 3}, TC_U8, NAN, NAN, {1, 1, 1}, "aligned", 1},
    {"uniform/nifti_types/complex32.nii", {3, 3, 1}, TC_F32, NAN, NAN, {1, 1, 1}, "scanner", 0},
    {"uniform/nifti_types/minimal.hdr", {64, 64, 10}, TC_U8, NAN, NAN, {3, 3, 3}, "voxel size only", -1},
    {"uniform/nifti_types/minimal_extended_hdr.nii", {8, 8, 1}, TC_F64, NAN, NAN, {1, 1, 1}, "aligned", -1},
    {"uniform/nifti_types/zstat1.nii.gz", {64, 64, 21}, TC_F32, NAN, NAN, {4, 4, 6}, "scanner", -1},
    {"malformed/nrrd_pynrrd/BallBinary30x30x30_bz2.nrrd",
     {30, 30, 30},
     TC_I16,
     0,
     257,
     {1, 1, 1},
     "left-posterior-superior",
     -1},
    {"malformed/nrrd_pynrrd/BallBinary30x30x30_gz_lineskip.nrrd",
     {30, 30, 30},
     TC_I16,
     0,
     257,
     {1, 1, 1},
     "left-posterior-superior",
     -1},
    {"malformed/nrrd_pynrrd/BallBinary30x30x30_byteskip_minus_one.nhdr",
     {30, 30, 30},
     TC_I16,
     0,
     257,
     {1, 1, 1},
     "left-posterior-superior",
     -1},
};

static void test_case(const char *data, const data_case *c) {
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", data, c->name);
    read_request r = request_for(path);
    r.component = c->component;
    read_image v;
    int status = image_read(&r, &v);
    EXPECT(status == 0, "%s: status %d: %s", c->name, status, failure_text());
    if (status) return;
    EXPECT(v.type == c->type, "%s: type %d", c->name, v.type);
    EXPECT(!memcmp(v.dims, c->dims, sizeof v.dims), "%s: dims %" PRId64 " %" PRId64 " %" PRId64, c->name, v.dims[0],
           v.dims[1], v.dims[2]);
    EXPECT(!strcmp(v.d.space, c->space), "%s: space '%s'", c->name, v.d.space);
    for (int i = 0; i < 3; i++) {
        double length =
            sqrt(v.matrix[0][i] * v.matrix[0][i] + v.matrix[1][i] * v.matrix[1][i] + v.matrix[2][i] * v.matrix[2][i]);
        EXPECT(fabs(length - c->spacing[i]) < 1e-5, "%s: spacing %g along axis %d", c->name, length, i);
    }
    double low = INFINITY, high = -INFINITY;
    for (int64_t i = 0; i < v.dims[0] * v.dims[1] * v.dims[2]; i++) {
        low = fmin(low, image_value(&v, (uint64_t)i));
        high = fmax(high, image_value(&v, (uint64_t)i));
    }
    EXPECT(isnan(c->low) || (low == c->low && high == c->high), "%s: values %g to %g", c->name, low, high);
    image_release(&v);
}

/* One volume in several wrappings. */
static void test_same(const char *data, const char *first, const char *second) {
    char a_path[1024], b_path[1024];
    snprintf(a_path, sizeof a_path, "%s/malformed/nrrd_pynrrd/BallBinary30x30x30%s", data, first);
    snprintf(b_path, sizeof b_path, "%s/malformed/nrrd_pynrrd/BallBinary30x30x30%s", data, second);
    read_request a_request = request_for(a_path), b_request = request_for(b_path);
    read_image a, b;
    int a_status = image_read(&a_request, &a), b_status = image_read(&b_request, &b);
    EXPECT(!a_status && !b_status && !memcmp(a.samples, b.samples, 54000), "%s differs from %s: %s", second, first,
           failure_text());
    image_release(&a);
    image_release(&b);
}

/* Whatever a file holds: a volume that can be read to its end, or STATUS_INPUT; STATUS_USAGE where the text asks for an
 * option. */
static int test_any(const char *path, const struct stat *about, int kind, struct FTW *at) {
    (void)about;
    (void)at;
    if (kind != FTW_F) return 0;
    for (int choice = -1; choice < 1; choice++) {
        read_request r = request_for(path);
        r.component = r.frame = choice;
        read_image v;
        fail(0, "(no text)");
        int status = image_read(&r, &v);
        int is_raw = strlen(path) > 4 && !strcmp(path + strlen(path) - 4, ".raw");
        int is_open = is_raw || strstr(failure_text(), "; choose one with --");
        EXPECT(status == 0 || status == (is_open ? STATUS_USAGE : STATUS_INPUT), "%s: status %d: %s", path, status,
               failure_text());
        EXPECT(status == 0 || strcmp(failure_text(), "(no text)"), "%s: no text", path);
        EXPECT(status == 0 || is_zero(&v), "%s: not zeroed", path);
        volatile double sum = 0;
        for (int64_t i = 0; !status && i < v.dims[0] * v.dims[1] * v.dims[2]; i++)
            sum = sum + image_value(&v, (uint64_t)i);
        image_release(&v);
    }
    return 0;
}

int main(void) {
    const char *data = getenv("TETRACUBES_DATA");
    if (!data || !*data) {
        printf("skipped: TETRACUBES_DATA is unset\n");
        return SKIPPED;
    }
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) test_case(data, &cases[i]);
    static const char *const wrappings[] = {".nhdr",
                                            "_bz2.nrrd",
                                            "_gz.nrrd",
                                            "_gz_lineskip.nrrd",
                                            "_gz_byteskip_minus_one.nrrd",
                                            "_byteskip_minus_one.nhdr"};
    for (size_t i = 0; i < sizeof wrappings / sizeof *wrappings; i++) test_same(data, ".nrrd", wrappings[i]);
    char path[1024];
    snprintf(path, sizeof path, "%s/malformed", data);
    nftw(path, test_any, 8, FTW_PHYS);
    snprintf(path, sizeof path, "%s/uniform", data);
    nftw(path, test_any, 8, FTW_PHYS);
    return EXPECT_DONE();
}
