/*
 * test_write.c - the mesh writers: files read back by parsers of their own, and failures that leave nothing behind
 *
 * Usage: test_write [SEED]
 */
#include "exit_status.h"
#include "expect.h"
#include "failure.h"
#include "folder.h"
#include "mesh_packages.h"
#include "mesh_write.h"

#include <dirent.h>
#include <fcntl.h>
#include <math.h>
#include <sched.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* The same triangles with three vertices of their own each. */
static tc_mesh_data unshared(const tc_mesh_data *mesh) {
    tc_mesh_data soup = make_mesh(3 * mesh->triangle_count, mesh->triangle_count, mesh->normals != NULL);
    for (uint32_t corner = 0; corner < soup.vertex_count; corner++) {
        uint64_t source = mesh->triangles[corner];
        memcpy((float *)(uintptr_t)soup.positions + 3 * (uint64_t)corner, mesh->positions + 3 * source, 12);
        if (mesh->normals)
            memcpy((float *)(uintptr_t)soup.normals + 3 * (uint64_t)corner, mesh->normals + 3 * source, 12);
        ((uint32_t *)(uintptr_t)soup.triangles)[corner] = corner;
    }
    return soup;
}

static int are_equal(const void *a, const void *b, uint64_t bytes) { return bytes == 0 || memcmp(a, b, bytes) == 0; }

static void expect_mesh(const char *name, const tc_mesh_data *is, const tc_mesh_data *should) {
    EXPECT(is->vertex_count == should->vertex_count && is->triangle_count == should->triangle_count,
           "%s: %llu vertices and %llu triangles, should be %llu and %llu", name, (unsigned long long)is->vertex_count,
           (unsigned long long)is->triangle_count, (unsigned long long)should->vertex_count,
           (unsigned long long)should->triangle_count);
    EXPECT(!is->normals == !should->normals, "%s: normals present: %d, should be %d", name, is->normals != NULL,
           should->normals != NULL);
    if (is->vertex_count != should->vertex_count || is->triangle_count != should->triangle_count) return;
    EXPECT(are_equal(is->positions, should->positions, 12 * is->vertex_count), "%s: positions differ", name);
    EXPECT(are_equal(is->triangles, should->triangles, 12 * is->triangle_count), "%s: triangles differ", name);
    if (is->normals && should->normals)
        EXPECT(are_equal(is->normals, should->normals, 12 * is->vertex_count), "%s: normals differ", name);
}

/* --------------------------------------------------------------------------------------------------------- helpers */

static const char *path_of(const char *name) {
    static char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

/* Entries of the test's folder; each test leaves none. */
static int count_files(void) {
    int count = 0;
    DIR *directory = opendir(folder);
    if (!directory) return -1;
    for (struct dirent *entry; (entry = readdir(directory));)
        count += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
    closedir(directory);
    return count;
}

static void expect_failure(const char *name, int is, int should, const char *words) {
    EXPECT(is == should, "%s: status %d, should be %d", name, is, should);
    EXPECT(strstr(failure_text(), words), "%s: the text lacks \"%s\": %s", name, words, failure_text());
}

static void make_file(const char *path, const char *text) {
    FILE *file = fopen(path, "w");
    if (!file) exit(EXIT_FAILURE);
    fputs(text, file);
    fclose(file);
}

static int holds(const char *path, const char *text) {
    size_t bytes;
    char *is = read_file(path, &bytes);
    int same = is && strcmp(is, text) == 0;
    free(is);
    return same;
}

/* ------------------------------------------------------------------------------------------------------- read back */

static const struct {
    const char *ending;
    tc_mesh_data (*parse)(const char *text, size_t bytes);
} formats[] = {{"ply", parse_ply}, {"obj", parse_obj}, {"stl", parse_stl},   {"vtp", parse_vtp}, {"off", parse_off},
               {"glb", parse_glb}, {"npz", parse_npz}, {"html", parse_html}, {"PLY", parse_ply}, {"Obj", parse_obj},
               {"sTL", parse_stl}, {"VTP", parse_vtp}, {"Off", parse_off},   {"GLB", parse_glb}, {"nPZ", parse_npz}};

enum { FORMAT_COUNT = 8 }; /* in lower case */

/* The right-hand rule in long double. Slivers are let pass: rounding decides where they face. */
static int is_facet_normal(const float normal[3], const float *corners, uint64_t *sliver_count) {
    long double u[3], v[3], n[3], error = 0;
    for (int axis = 0; axis < 3; axis++) {
        u[axis] = (long double)corners[3 + axis] - corners[axis];
        v[axis] = (long double)corners[6 + axis] - corners[axis];
    }
    for (int axis = 0; axis < 3; axis++) {
        int next = (axis + 1) % 3, last = (axis + 2) % 3;
        n[axis] = u[next] * v[last] - u[last] * v[next];
    }
    long double length = hypotl(hypotl(n[0], n[1]), n[2]);
    if (length <= 1e-6L * hypotl(hypotl(u[0], u[1]), u[2]) * hypotl(hypotl(v[0], v[1]), v[2])) {
        ++*sliver_count;
        return 1;
    }
    for (int axis = 0; axis < 3; axis++) error += fabsl(normal[axis] - n[axis] / length);
    return error < 1e-6L;
}

static void expect_facet_normals(const char *name, const tc_mesh_data *stl) {
    uint64_t wrong = 0, slivers = 0;
    for (uint64_t t = 0; t < stl->triangle_count; t++)
        wrong += !is_facet_normal(stl->normals + 9 * t, stl->positions + 9 * t, &slivers);
    EXPECT(wrong == 0, "%s: %llu facet normals are wrong", name, (unsigned long long)wrong);
    EXPECT(stl->triangle_count < 1000 || slivers < stl->triangle_count / 10 * 9, "%s: %llu slivers", name,
           (unsigned long long)slivers);
}

static void test_read_back(const tc_mesh_data *mesh, int soup, size_t which) {
    char name[256];
    snprintf(name, sizeof name, "%llu triangles, normals %d, soup %d.%s", (unsigned long long)mesh->triangle_count,
             mesh->normals != NULL, soup, formats[which].ending);
    char path[512];
    snprintf(path, sizeof path, "%s", path_of(name));
    mesh_write_options options = {.soup = soup};
    int is_stl = formats[which].parse == parse_stl, status = mesh_write(path, mesh, &options);
    EXPECT(status == 0, "%s: status %d: %s", name, status, failure_text());
    size_t bytes;
    char *text = read_file(path, &bytes);
    EXPECT(text != NULL, "%s is missing", name);
    if (!text) return;

    tc_mesh_data is = formats[which].parse(text, bytes), should = soup || is_stl ? unshared(mesh) : *mesh;
    if (is_stl) {
        expect_facet_normals(name, &is);
        free((void *)(uintptr_t)is.normals);
        is.normals = NULL;
    }
    tc_mesh_data compared = should;
    const int has_no_normals = is_stl || formats[which].parse == parse_off;
    if (has_no_normals || (formats[which].parse == parse_obj && !should.vertex_count)) compared.normals = NULL;
    if (formats[which].parse == parse_glb && !mesh->triangle_count) compared = (tc_mesh_data){0}; /* none is empty */
    expect_mesh(name, &is, &compared);
    EXPECT(count_files() == 1, "%s: %d files", name, count_files());
    if (soup || is_stl) free_mesh(&should);
    free_mesh(&is);
    free(text);
    unlink(path);
}

static void test_meshes(void) {
    /* Small; none; with unused vertices; longer than the writers' blocks and buffers, and no multiple of them. */
    static const uint64_t sizes[][2] = {{4, 4}, {0, 0}, {7, 0}, {1, 1}, {100003, 200009}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (int with_normals = 0; with_normals < 2; with_normals++) {
            tc_mesh_data mesh = make_mesh(sizes[i][0], sizes[i][1], with_normals);
            for (int soup = 0; soup < 2; soup++)
                for (size_t f = 0; f < (sizes[i][1] > 4 ? FORMAT_COUNT : sizeof formats / sizeof *formats); f++)
                    test_read_back(&mesh, soup, f);
            free_mesh(&mesh);
        }
}

/* The same where blocks are encoded by one thread. */
static void test_one_processor(void) {
    cpu_set_t all, one;
    if (sched_getaffinity(0, sizeof all, &all) != 0) return;
    CPU_ZERO(&one);
    CPU_SET((size_t)sched_getcpu(), &one);
    EXPECT(sched_setaffinity(0, sizeof one, &one) == 0, "sched_setaffinity");
    test_meshes();
    sched_setaffinity(0, sizeof all, &all);
}

/* Facets of ordinary shape, one of them without area. */
static void test_facets(void) {
    const float positions[4][3] = {{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {4, 0, 0}};
    const uint32_t triangles[3][3] = {{0, 1, 2}, {0, 2, 1}, {0, 1, 3}};
    const float should[3] = {1, -1, 0};
    tc_mesh_data mesh = {.vertex_count = 4, .triangle_count = 3, .positions = positions[0], .triangles = triangles[0]};
    EXPECT(mesh_write(path_of("facets.stl"), &mesh, NULL) == 0, "%s", failure_text());
    size_t bytes;
    char *text = read_file(path_of("facets.stl"), &bytes);
    for (int t = 0; text && t < 3; t++) {
        float normal[3];
        get_floats(text + 84 + 50 * t, normal);
        EXPECT(normal[0] == 0 && normal[1] == 0 && normal[2] == should[t], "facet %d: normal %g %g %g", t, normal[0],
               normal[1], normal[2]);
    }
    EXPECT(text && bytes == 84 + 150, "%zu bytes", bytes);
    free(text);
    unlink(path_of("facets.stl"));
}

/* What a person reads: short numbers stay short. */
static void test_obj_text(void) {
    const float positions[5][3] = {{0, 1, -2.5f},
                                   {100, 1234567936, 0.0001f},
                                   {0.1f, 1e-6f, 3e30f},
                                   {8388607.5f, 123456792, -0.0f},
                                   {1e9f, 1e10f, 1e-23f}}; /* nine digits of 9.9999999982e-24 round up to ten */
    const uint32_t triangle[3] = {0, 1, 2};
    tc_mesh_data mesh = {.vertex_count = 5, .triangle_count = 1, .positions = positions[0], .triangles = triangle};
    EXPECT(mesh_write(path_of("text.obj"), &mesh, NULL) == 0, "%s", failure_text());
    EXPECT(holds(path_of("text.obj"), "# tetracubes isosurface: 5 vertices, 1 triangles\n"
                                      "v 0 1 -2.5\n"
                                      "v 100 1.23456794e+9 0.0000999999975\n"
                                      "v 0.100000001 9.99999997e-7 2.99999989e+30\n"
                                      "v 8388607.5 123456792 -0\n"
                                      "v 1e+9 1e+10 1e-23\n"
                                      "f 1 2 3\n"),
           "OBJ text differs");
    unlink(path_of("text.obj"));
}

/* -------------------------------------------------------------------------------------------------------- failures */

static void test_formats_named(const tc_mesh_data *mesh) {
    static const char *const bad[] = {"mesh.xyz", "mesh", "ply", "", ".", "folder.ply/mesh", "mesh.", "mesh.ply.gz"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        expect_failure(bad[i], mesh_write_check(bad[i], NULL), STATUS_USAGE, "ply");
        expect_failure(bad[i], mesh_write(bad[i], mesh, NULL), STATUS_USAGE, "obj");
    }
    mesh_write_options vtk = {.format = "vtk"}, stl = {.format = "STL"};
    expect_failure("format vtk", mesh_write_check("mesh.ply", &vtk), STATUS_USAGE, "\"vtk\"");
    expect_failure("format vtk", mesh_write("mesh.ply", mesh, &vtk), STATUS_USAGE,
                   "ply, vtp, stl, obj, off, glb, html or npz");
    EXPECT(mesh_write_check("a.b/mesh.Ply", NULL) == 0, "ending in mixed case");
    EXPECT(mesh_write_check("/dev/stdout", &stl) == 0, "named format without an ending");

    EXPECT(mesh_write(path_of("mesh.ply"), mesh, &stl) == 0, "%s", failure_text());
    size_t bytes;
    char *text = read_file(path_of("mesh.ply"), &bytes);
    EXPECT(text && bytes == 84 + 50 * mesh->triangle_count, "the named format does not win over the ending");
    free(text);
    unlink(path_of("mesh.ply"));
}

static void test_limits(void) {
    const uint64_t limit = UINT32_MAX;
    mesh_write_options soup = {.soup = 1};
    tc_mesh_data many_vertices = {.vertex_count = limit + 1}, many_triangles = {.triangle_count = limit + 1};
    tc_mesh_data third = {.triangle_count = limit / 3 + 1};
    expect_failure("vertices", mesh_write(path_of("a.ply"), &many_vertices, NULL), STATUS_FAILED, "2^32 - 1");
    expect_failure("vertices", mesh_write(path_of("a.obj"), &many_vertices, NULL), STATUS_FAILED, "2^32 - 1");
    expect_failure("triangles", mesh_write(path_of("a.stl"), &many_triangles, NULL), STATUS_FAILED, "2^32 - 1");
    expect_failure("soup", mesh_write(path_of("a.ply"), &third, &soup), STATUS_FAILED, "2^32 - 1");
    expect_failure("soup", mesh_write(path_of("a.obj"), &third, &soup), STATUS_FAILED, "2^32 - 1");
    tc_mesh_data large = {.vertex_count = 180000000, .triangle_count = 180000000}, fits = large;
    expect_failure("4 GiB", mesh_write(path_of("a.glb"), &large, NULL), STATUS_FAILED,
                   "write ply, vtp, obj, off or npz");
    expect_failure("4 GiB", mesh_write(path_of("a.glb"), &third, &soup), STATUS_FAILED, "2^32 - 1");
    tc_mesh_data page = {.vertex_count = 1 << 24, .triangle_count = (1 << 24) + 1}; /* 2^28 characters, and more */
    expect_failure("page", mesh_write(path_of("a.html"), &page, NULL), STATUS_FAILED,
                   "are more than html holds; write ply");
    page.triangle_count--;
    expect_failure("page", mesh_write(path_of("none/a.html"), &page, NULL), STATUS_FAILED, "create the folder");
    fits.vertex_count = 177900000; /* its file would have 4,294,800,000 bytes and a few: the folder is looked for */
    expect_failure("less", mesh_write(path_of("none/a.glb"), &fits, NULL), STATUS_FAILED, "create the folder");
    EXPECT(count_files() == 0, "%d files", count_files());
}

static void test_bad_targets(const tc_mesh_data *mesh) {
    mesh_write_options ply = {.format = "ply"};
    expect_failure("no folder", mesh_write(path_of("none/mesh.ply"), mesh, NULL), STATUS_FAILED, "create the folder");
    expect_failure("folder", mesh_write(folder, mesh, &ply), STATUS_FAILED, "irectory");
    expect_failure("folder", mesh_write(path_of(""), mesh, &ply), STATUS_FAILED, "irectory");
    expect_failure("no name", mesh_write("", mesh, &ply), STATUS_FAILED, "cannot be written");
    make_file(path_of("file"), "kept");
    expect_failure("file as folder", mesh_write(path_of("file/mesh.ply"), mesh, NULL), STATUS_FAILED, "irectory");
    EXPECT(holds(path_of("file"), "kept"), "a file on the way was changed");
    unlink(path_of("file"));
    EXPECT(count_files() == 0, "%d files", count_files());
}

/* Gives up the rights of root, whose writes never fail. For child processes. */
static void drop_privileges(void) {
    if (geteuid() == 0 && (setgid(65534) != 0 || setuid(65534) != 0)) _exit(100);
}

/* mesh_write in a child without privileges: its status, or 101 where the text lacks the words. */
static int write_unprivileged(const char *path, const tc_mesh_data *mesh, const char *format, const char *words) {
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        mesh_write_options options = {.format = format};
        drop_privileges();
        int status = mesh_write(path, mesh, &options);
        _exit(status == 0 || strstr(failure_text(), words) ? status : 101);
    }
    int status = -1;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static void test_no_permission(const tc_mesh_data *mesh) {
    make_file(path_of("old.ply"), "kept");
    chmod(path_of("old.ply"), 0444);
    chmod(folder, 0777);
    int status = write_unprivileged(path_of("old.ply"), mesh, "ply", "Permission denied");
    EXPECT(status == STATUS_FAILED, "protected file: %d", status);
    chmod(folder, 0555);
    status = write_unprivileged(path_of("new.ply"), mesh, "ply", "Permission denied");
    EXPECT(status == STATUS_FAILED, "protected folder: %d", status);
    chmod(folder, 0755);
    EXPECT(holds(path_of("old.ply"), "kept") && count_files() == 1, "a protected file or folder was changed");
    unlink(path_of("old.ply"));
}

/* Writes with the limit on file sizes as a full disk. */
static int write_limited(const char *path, const tc_mesh_data *mesh, rlim_t limit) {
    struct rlimit old, small;
    getrlimit(RLIMIT_FSIZE, &old);
    small = (struct rlimit){limit, old.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
    int status = mesh_write(path, mesh, NULL);
    setrlimit(RLIMIT_FSIZE, &old);
    return status;
}

static void expect_nothing_left(const char *name, const tc_mesh_data *mesh, rlim_t limit) {
    char path[512];
    snprintf(path, sizeof path, "%s", path_of(name));
    expect_failure(name, write_limited(path, mesh, limit), STATUS_FAILED, "File too large");
    EXPECT(count_files() == 0, "%s, limit %llu: %d files are left", name, (unsigned long long)limit, count_files());

    make_file(path, "kept");
    expect_failure(name, write_limited(path, mesh, limit), STATUS_FAILED, path);
    EXPECT(holds(path, "kept"), "%s, limit %llu: the old file was changed", name, (unsigned long long)limit);
    EXPECT(count_files() == 1, "%s, limit %llu: %d files are left", name, (unsigned long long)limit, count_files());
    unlink(path);
}

static void test_full_disk(const tc_mesh_data *mesh) {
    static const char *const names[] = {"full.ply", "full.stl", "full.obj", "full.vtp"};
    if (access("/dev/full", W_OK) != 0) printf("skipped: no /dev/full\n");
    for (int i = 0; i < 4 && access("/dev/full", W_OK) == 0; i++) {
        int status = write_unprivileged("/dev/full", mesh, names[i] + strlen("full."), "free space");
        EXPECT(status == STATUS_FAILED, "/dev/full as %s: %d", names[i], status);
    }

    signal(SIGXFSZ, SIG_IGN);
    for (int i = 0; i < 4; i++) {
        struct stat whole = {0};
        EXPECT(mesh_write(path_of(names[i]), mesh, NULL) == 0, "%s", failure_text());
        stat(path_of(names[i]), &whole);
        unlink(path_of(names[i]));
        expect_nothing_left(names[i], mesh, 50);                        /* fails in the first write */
        expect_nothing_left(names[i], mesh, (rlim_t)whole.st_size / 2); /* in a later one */
        expect_nothing_left(names[i], mesh, (rlim_t)whole.st_size - 1); /* in the last */
    }
    signal(SIGXFSZ, SIG_DFL);
}

/* Writes to a FIFO whose reader leaves after the first bytes, while later blocks are being encoded. */
static void test_closed_pipe(const tc_mesh_data *mesh) {
    static const char *const names[] = {"closed.ply", "closed.stl", "closed.obj", "closed.vtp"};
    signal(SIGPIPE, SIG_IGN);
    for (int i = 0; i < 4; i++) {
        EXPECT(mkfifo(path_of(names[i]), 0600) == 0, "mkfifo");
        fflush(stdout);
        pid_t child = fork();
        if (child == 0) {
            char head[1000];
            int fd = open(path_of(names[i]), O_RDONLY);
            _exit(read(fd, head, sizeof head) > 0 ? 0 : 1);
        }
        expect_failure(names[i], mesh_write(path_of(names[i]), mesh, NULL), STATUS_FAILED, "Broken pipe");
        waitpid(child, NULL, 0);
        EXPECT(count_files() == 1, "%s: %d files", names[i], count_files());
        unlink(path_of(names[i]));
    }
    signal(SIGPIPE, SIG_DFL);
}

/* --------------------------------------------------------------------------------------------------------- targets */

static mode_t mode_of(const char *path) {
    struct stat s;
    return stat(path, &s) == 0 ? s.st_mode & 0777 : 0;
}

static int is_ply(const char *path) {
    size_t bytes;
    char *text = read_file(path, &bytes);
    int yes = text && strncmp(text, "ply\n", 4) == 0;
    free(text);
    return yes;
}

static void test_replacement(const tc_mesh_data *mesh) {
    mode_t old_mask = umask(027);
    EXPECT(mesh_write(path_of("a.ply"), mesh, NULL) == 0, "%s", failure_text());
    EXPECT(mode_of(path_of("a.ply")) == 0640, "mode %o under umask 027", (unsigned)mode_of(path_of("a.ply")));
    umask(old_mask);

    make_file(path_of("a.ply"), "old");
    chmod(path_of("a.ply"), 0604);
    EXPECT(mesh_write(path_of("a.ply"), mesh, NULL) == 0 && is_ply(path_of("a.ply")), "not replaced");
    EXPECT(mode_of(path_of("a.ply")) == 0604, "mode %o, was 604", (unsigned)mode_of(path_of("a.ply")));

    struct stat link;
    make_file(path_of("a.ply"), "old");
    EXPECT(symlink("a.ply", path_of("link.ply")) == 0, "symlink");
    EXPECT(mesh_write(path_of("link.ply"), mesh, NULL) == 0 && is_ply(path_of("a.ply")), "the link's target stays");
    EXPECT(lstat(path_of("link.ply"), &link) == 0 && S_ISLNK(link.st_mode), "the link was replaced");
    EXPECT(count_files() == 2, "%d files", count_files());
    unlink(path_of("link.ply"));
    unlink(path_of("a.ply"));
}

/* Relative names, in the working folder and below; a name near the longest that a folder takes. */
static void test_names(const tc_mesh_data *mesh) {
    char before[4096], name[256];
    memset(name, 'n', 251);
    strcpy(name + 251, ".ply");
    if (!getcwd(before, sizeof before) || chdir(folder) != 0) exit(EXIT_FAILURE);
    EXPECT(mesh_write("plain.ply", mesh, NULL) == 0 && is_ply("plain.ply"), "%s", failure_text());
    EXPECT(mesh_write("./dot.ply", mesh, NULL) == 0 && is_ply("dot.ply"), "%s", failure_text());
    EXPECT(mesh_write(name, mesh, NULL) == 0 && is_ply(name), "%s", failure_text());
    EXPECT(count_files() == 3, "%d files", count_files());
    unlink("plain.ply");
    unlink("dot.ply");
    unlink(name);
    if (chdir(before) != 0) exit(EXIT_FAILURE);
}

static void test_devices(const tc_mesh_data *mesh) {
    EXPECT(write_unprivileged("/dev/null", mesh, "ply", "") == 0, "/dev/null");
    EXPECT(mkfifo(path_of("fifo.ply"), 0600) == 0, "mkfifo");
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        char head[4] = {0}, rest[65536];
        int fd = open(path_of("fifo.ply"), O_RDONLY);
        ssize_t got = read(fd, head, 4);
        while (read(fd, rest, sizeof rest) > 0) continue;
        _exit(got == 4 && memcmp(head, "ply\n", 4) == 0 ? 0 : 1);
    }
    int status = 1;
    EXPECT(mesh_write(path_of("fifo.ply"), mesh, NULL) == 0, "%s", failure_text());
    waitpid(child, &status, 0);
    EXPECT(status == 0, "the reader of the FIFO got no PLY");
    EXPECT(count_files() == 1, "%d files", count_files());
    unlink(path_of("fifo.ply"));
}

/* Standard output that is a file keeps what stands in it: "(echo x; tetracubes ... -o /dev/stdout) > file". */
static void test_standard_output(const tc_mesh_data *mesh) {
    mesh_write_options ply = {.format = "ply"};
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        int fd = open(path_of("out"), O_WRONLY | O_CREAT, 0600);
        if (dup2(fd, STDOUT_FILENO) < 0 || write(STDOUT_FILENO, "x\n", 2) != 2) _exit(100);
        drop_privileges();
        _exit(mesh_write("/dev/stdout", mesh, &ply));
    }
    int status = 1;
    size_t bytes;
    waitpid(child, &status, 0);
    char *text = read_file(path_of("out"), &bytes);
    EXPECT(status == 0 && text && strncmp(text, "x\nply\n", 6) == 0, "status %d, output %.20s", status,
           text ? text : "");
    EXPECT(count_files() == 1, "%d files", count_files());
    free(text);
    unlink(path_of("out"));
}

int main(int argc, char **argv) {
    random_state = argc > 1 ? strtoull(argv[1], NULL, 0) : 1996;
    printf("seed %llu\n", (unsigned long long)random_state);
    folder_make("write");
    tc_mesh_data small = make_mesh(4, 4, 1), large = make_mesh(200000, 200000, 0);
    test_meshes();
    test_one_processor();
    test_facets();
    test_obj_text();
    test_formats_named(&small);
    test_limits();
    test_bad_targets(&small);
    test_no_permission(&small);
    test_full_disk(&large);
    test_closed_pipe(&large);
    test_replacement(&small);
    test_names(&small);
    test_devices(&large);
    test_standard_output(&small);
    EXPECT(count_files() == 0, "%d files are left", count_files());
    folder_remove();
    free_mesh(&small);
    free_mesh(&large);
    return EXPECT_DONE();
}
