/*
 * test_mesh_pieces.c - meshes written piece by piece are the files that are written at once, byte for byte
 *
 * Usage: test_mesh_pieces [SEED]
 */
#include "exit_status.h"
#include "expect.h"
#include "failure.h"
#include "folder.h"
#include "mesh_write.h"
#include "random.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <signal.h>

enum { PIECES = 6, VERTICES = 500, TRIANGLES = 900, FILE_MOST = 1 << 20 };

static float positions[3 * PIECES * VERTICES], normals[3 * PIECES * VERTICES], heat[PIECES * VERTICES],
    flow[3 * PIECES * VERTICES];
static uint32_t triangles[3 * PIECES * TRIANGLES], local[3 * PIECES * TRIANGLES];

typedef struct cut {
    uint64_t vertex[PIECES + 1], triangle[PIECES + 1]; /* where pieces begin */
} cut;

/* Triangles of a piece use its vertices; its last ones those of the next piece too. Some pieces have no vertices or no
 * triangles. */
static cut mesh_make(tc_mesh_data *mesh, int has_normals, int is_far) {
    cut c = {{0}, {0}};
    for (int n = 0; n < PIECES; n++) {
        const int is_bare = random_below(5) == 0;
        c.vertex[n + 1] = c.vertex[n] + (is_bare ? 0 : 1 + random_below(VERTICES - 1));
        c.triangle[n + 1] = c.triangle[n] + (is_bare ? 0 : random_below(TRIANGLES));
    }
    for (uint64_t v = 0; v < 3 * c.vertex[PIECES]; v++) {
        positions[v] = (float)random_between(-5, 5);
        normals[v] = (float)random_between(-1, 1);
        flow[v] = (float)random_between(-1, 1);
        heat[v / 3] = (float)random_between(0, 100);
    }
    for (int n = 0; n < PIECES; n++) {
        const uint64_t own = c.vertex[n + 1] - c.vertex[n],
                       next = n + 2 <= PIECES ? c.vertex[n + 2] - c.vertex[n] : own;
        for (uint64_t t = c.triangle[n]; t < c.triangle[n + 1]; t++) {
            const int is_last = t + 50 > c.triangle[n + 1];
            for (int corner = 0; corner < 3; corner++) {
                local[3 * t + (uint64_t)corner] = random_below((uint32_t)(is_last ? next : own));
                triangles[3 * t + (uint64_t)corner] = (uint32_t)c.vertex[n] + local[3 * t + (uint64_t)corner];
            }
        }
    }
    *mesh = (tc_mesh_data){.struct_size = sizeof *mesh,
                           .vertex_count = c.vertex[PIECES],
                           .triangle_count = c.triangle[PIECES],
                           .positions = positions,
                           .normals = has_normals ? normals : NULL,
                           .triangles = triangles,
                           .origin = {is_far ? 4e6 : 0, 0, 0}};
    return c;
}

static const char *path_of(const char *name) {
    static char paths[2][512];
    static int which;
    char *path = paths[which ^= 1];
    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

static size_t file_read(const char *path, char *bytes) {
    FILE *file = fopen(path, "rb");
    const size_t count = file ? fread(bytes, 1, FILE_MOST, file) : 0;
    if (file) fclose(file);
    return count;
}

static int files_differ(const char *a, const char *b) {
    static char bytes[2][FILE_MOST];
    const size_t count = file_read(a, bytes[0]);
    return count == 0 || count == FILE_MOST || file_read(b, bytes[1]) != count || memcmp(bytes[0], bytes[1], count);
}

/* Of the piece's vertices. */
static tc_mesh_data piece_of(const tc_mesh_data *mesh, const cut *c, int n, vertex_array fields[2]) {
    const uint64_t v = c->vertex[n], t = c->triangle[n], count = c->vertex[n + 1] - v;
    tc_mesh_data piece = *mesh;
    piece.vertex_count = count;
    piece.triangle_count = c->triangle[n + 1] - t;
    piece.positions = count ? positions + 3 * v : NULL;
    piece.normals = mesh->normals && count ? normals + 3 * v : NULL;
    piece.triangles = piece.triangle_count ? local + 3 * t : NULL;
    fields[0] = (vertex_array){"heat", 1, heat + v, ROLE_DATA};
    fields[1] = (vertex_array){"flow", 3, flow + 3 * v, ROLE_DATA};
    return piece;
}

static int pieces_write(const char *path, const mesh_write_options *options, const tc_mesh_data *mesh, const cut *c,
                        int end) {
    mesh_file *file;
    vertex_array fields[2];
    int status = mesh_file_open(path, options, mesh, &file);
    for (int n = 0; n < end && !status; n++) {
        const tc_mesh_data piece = piece_of(mesh, c, n, fields);
        if (piece.vertex_count || piece.triangle_count)
            status = mesh_file_add(file, c->vertex[n], c->triangle[n], &piece, fields);
    }
    if (end == PIECES && !status) return mesh_file_close(file);
    mesh_file_discard(file);
    return status;
}

static void expect_same(const char *ending, const tc_mesh_data *mesh, const cut *c, int has_fields) {
    char names[2][32];
    vertex_array fields[2];
    piece_of(mesh, c, 0, fields);
    fields[0].values = heat, fields[1].values = flow;
    const mesh_write_options options = {.fields = fields, .field_count = has_fields ? 2 : 0};
    snprintf(names[0], sizeof names[0], "whole.%s", ending);
    snprintf(names[1], sizeof names[1], "pieces.%s", ending);
    const char *whole = path_of(names[0]), *pieces = path_of(names[1]);
    EXPECT(mesh_file_check(pieces, &options) == 0, "%s: %s", ending, failure_text());
    EXPECT(mesh_write(whole, mesh, &options) == 0, "%s: %s", ending, failure_text());
    EXPECT(pieces_write(pieces, &options, mesh, c, PIECES) == 0, "%s in pieces: %s", ending, failure_text());
    EXPECT(!files_differ(whole, pieces), "%s: pieces make another file, of %d vertices%s%s%s", ending,
           (int)mesh->vertex_count, mesh->normals ? ", normals" : "", has_fields ? ", fields" : "",
           mesh->origin[0] != 0 ? ", far" : "");
    remove(whole);
    remove(pieces);
}

static void test_same(void) {
#ifdef HAVE_MESH_WRITE_HDF5
    static const char *const endings[] = {"ply", "vtp", "stl", "vtkhdf"};
#else
    static const char *const endings[] = {"ply", "vtp", "stl"};
#endif
    const int count = sizeof endings / sizeof *endings;
    for (int n = 0; n < 48; n++) {
        tc_mesh_data mesh;
        const cut c = mesh_make(&mesh, n & 1, n >> 1 & 1);
        for (int e = 0; e < count; e++) expect_same(endings[e], &mesh, &c, e != 2 && n & 4);
    }
    tc_mesh_data mesh;
    cut c = mesh_make(&mesh, 0, 0);
    memset(&c, 0, sizeof c);
    mesh.vertex_count = mesh.triangle_count = 0;
    for (int e = 0; e < count; e++) expect_same(endings[e], &mesh, &c, 0);
}

static int count_files(void) {
    int count = -2;
    DIR *directory = opendir(folder);
    while (directory && readdir(directory)) count++;
    closedir(directory);
    return count;
}

static void test_refused(void) {
    const mesh_write_options soup = {.soup = 1};
    EXPECT(mesh_file_check("a.obj", NULL) == STATUS_USAGE && strstr(failure_text(), "ply, vtp"), "obj: %s",
           failure_text());
    EXPECT(mesh_file_check("a.ply", &soup) == STATUS_USAGE, "soup is taken");
    EXPECT(mesh_file_check("/dev/null", &(mesh_write_options){.format = "ply"}) == STATUS_USAGE, "a device is taken");
}

/* A file that is given up, at any point, or too large for the disk, leaves nothing. */
static void test_ended(void) {
    tc_mesh_data mesh;
    vertex_array fields[2];
    struct rlimit limit;
    const cut c = mesh_make(&mesh, 1, 0);
    const mesh_write_options options = {.fields = fields, .field_count = 0};
    const char *path = path_of("ended.ply");
    for (int end = 0; end < PIECES; end++) {
        EXPECT(pieces_write(path, &options, &mesh, &c, end) == 0, "%s", failure_text());
        EXPECT(count_files() == 0, "a file of %d pieces is left", end);
    }
    signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &limit);
    setrlimit(RLIMIT_FSIZE, &(struct rlimit){20000, limit.rlim_max});
    const int status = pieces_write(path, &options, &mesh, &c, PIECES);
    setrlimit(RLIMIT_FSIZE, &limit);
    EXPECT(status == STATUS_FAILED && strstr(failure_text(), "ended.ply"), "a file that is too large: %s",
           failure_text());
    EXPECT(count_files() == 0, "a file that is too large is left");
    mesh_file_discard(NULL);
    EXPECT(mesh_file_close(NULL) == 0, "no file");
}

int main(int argc, char **argv) {
    random_state = argc > 1 ? strtoull(argv[1], NULL, 10) : 1;
    folder_make("pieces");
#ifdef HAVE_MESH_WRITE_HDF5
    mesh_write_add_hdf5();
#endif
    test_same();
    test_refused();
    test_ended();
    folder_remove();
    return EXPECT_DONE();
}
