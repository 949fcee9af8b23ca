/*
 * test_program_cache.c - the cache of built programs: used when right, replaced when not, missed by nobody
 *
 * A program that comes from the cache leaves its file alone; one that was built replaces it, and the file has another
 * inode then. That is how the two are told apart. Every extraction runs in a process of its own, so that contexts start
 * as they do for a user, and is compared with the reference.
 */
#include "api.h"
#include "folder.h"

#include <dirent.h>
#include <stdint.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { FILES_MOST = 16, PATH_MOST = 512, TEXT_MOST = 1 << 20 };

/* -------------------------------------------------------------------------------------------------- child processes */

static pid_t child_start(void (*work)(void)) {
    fflush(stdout);
    pid_t child = fork();
    if (child) return child;
    expect_failures = 0;
    work();
    fflush(stdout);
    _exit(expect_failures != 0);
}

static int child_end(pid_t child) {
    int status = -1;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static void device_look(void) { expect_failures = !device_exists(); }

static void extract_compare(void) {
    tc_context_options options;
    tc_grid_options grid;
    tc_extract_options how;
    tc_mesh *meshes[2] = {NULL, NULL};
    tc_mesh_data data[2];
    tc_context_options_init(&options);
    grid_describe(&grid);
    tc_extract_options_init(&how);
    how.isovalue = 127.5;
    tc_context *contexts[2] = {context_open(&options), reference_open()};
    for (int n = 0; n < 2; n++)
        if (!extract(contexts[n], &grid, &how, &meshes[n], &data[n])) return;
    const char *difference = mesh_difference(&data[1], &data[0]);
    EXPECT(!difference && data[0].triangle_count > 100, "%s", difference ? difference : "a mesh too small to compare");
    for (int n = 0; n < 2; n++) {
        tc_mesh_destroy(meshes[n]);
        tc_context_destroy(contexts[n]);
    }
}

static void extract_expect(const char *what) {
    int status = child_end(child_start(extract_compare));
    EXPECT(status == 0, "%s: exit status %d", what, status);
}

/* ------------------------------------------------------------------------------------------------------------ files */

typedef struct entry {
    char path[PATH_MOST];
    ino_t inode;
} entry;

typedef struct listing {
    int count;
    entry entries[FILES_MOST];
} listing;

static int by_path(const void *a, const void *b) { return strcmp(((const entry *)a)->path, ((const entry *)b)->path); }

static listing list(const char *path) {
    listing out = {0};
    struct stat about;
    DIR *open = opendir(path);
    for (struct dirent *d; open && (d = readdir(open)) && out.count < FILES_MOST;) {
        entry *e = &out.entries[out.count];
        snprintf(e->path, sizeof e->path, "%s/%s", path, d->d_name);
        if (*d->d_name == '.' || stat(e->path, &about)) continue;
        e->inode = about.st_ino;
        out.count++;
    }
    if (open) closedir(open);
    qsort(out.entries, (size_t)out.count, sizeof *out.entries, by_path);
    return out;
}

static bool names_same(const listing *a, const listing *b) {
    for (int n = 0; n < a->count && n < b->count; n++)
        if (strcmp(a->entries[n].path, b->entries[n].path)) return false;
    return a->count == b->count;
}

static int inodes_same(const listing *a, const listing *b) {
    int same = 0;
    for (int n = 0; n < a->count && n < b->count; n++) same += a->entries[n].inode == b->entries[n].inode;
    return same;
}

static size_t file_read(const char *path, char *out) {
    FILE *file = fopen(path, "rb");
    size_t count = file ? fread(out, 1, TEXT_MOST, file) : 0;
    if (file) fclose(file);
    return count;
}

static void file_write(const char *path, const char *bytes, size_t count) {
    FILE *file = fopen(path, "wb");
    EXPECT(file && fwrite(bytes, 1, count, file) == count && fclose(file) == 0, "%s cannot be written", path);
}

/* folder/name, set as the folder of the cache */
static const char *cache_folder(const char *name) {
    static char path[PATH_MOST];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    setenv("TETRACUBES_CACHE_DIR", path, 1);
    return path;
}

/* ------------------------------------------------------------------------------------------------------------ tests */

static void test_second_process(void) {
    const char *cache = cache_folder("deep/down/cache");
    extract_expect("an empty cache");
    listing first = list(cache);
    EXPECT(first.count == 2, "%d files for two programs", first.count);
    extract_expect("a warm cache");
    listing second = list(cache);
    EXPECT(names_same(&first, &second) && inodes_same(&first, &second) == 2, "the second process built programs");
}

static uint64_t fnv1a(const char *bytes, size_t count) {
    uint64_t hash = 14695981039346656037u;
    for (size_t n = 0; n < count; n++) hash = (hash ^ (uint8_t)bytes[n]) * 1099511628211u;
    return hash;
}

/* Head: 16 bytes of magic, then key_bytes, binary_bytes and the checksum of both. */
enum { KEY_BYTES = 16, CHECKSUM = 32, HEAD = 40 };

static void checksum_set(char *bytes, size_t count) {
    uint64_t sum = fnv1a(bytes + HEAD, count - HEAD);
    memcpy(bytes + CHECKSUM, &sum, sizeof sum);
}

static size_t binary_spoil(char *bytes, size_t count) {
    uint64_t key;
    memcpy(&key, bytes + KEY_BYTES, sizeof key);
    EXPECT(key > 1000 && HEAD + key < count, "a key of %d bytes", (int)key);
    memset(bytes + HEAD + key, 'x', count - HEAD - (size_t)key);
    checksum_set(bytes, count);
    return count;
}

static size_t key_spoil(char *bytes, size_t count) {
    bytes[HEAD + 900] ^= 1;
    checksum_set(bytes, count);
    return count;
}

static size_t lengths_spoil(char *bytes, size_t count) {
    memset(bytes + KEY_BYTES, 0xff, 16);
    return count;
}

static size_t magic_spoil(char *bytes, size_t count) { return bytes[0] ^= 1, count; }
static size_t last_spoil(char *bytes, size_t count) { return bytes[count - 1] ^= 1, count; }
static size_t cut_last(char *bytes, size_t count) { return (void)bytes, count - 1; }
static size_t cut_in_head(char *bytes, size_t count) { return (void)bytes, (void)count, (size_t)HEAD - 1; }
static size_t cut_all(char *bytes, size_t count) { return (void)bytes, (void)count, (size_t)0; }
static size_t add_byte(char *bytes, size_t count) { return bytes[count] = 0, count + 1; }

static const struct {
    const char *name;
    size_t (*apply)(char *bytes, size_t count);
} damages[] = {
    {"another magic", magic_spoil}, {"huge lengths", lengths_spoil},  {"a flipped last bit", last_spoil},
    {"cut by a byte", cut_last},    {"cut in its head", cut_in_head}, {"empty", cut_all},
    {"a byte too many", add_byte},  {"of another key", key_spoil},    {"of a binary that is none", binary_spoil},
};

static void test_damage(void) {
    static char bytes[TEXT_MOST + 1];
    const char *cache = cache_folder("deep/down/cache");
    for (size_t n = 0; n < sizeof damages / sizeof *damages; n++) {
        listing before = list(cache);
        for (int f = 0; f < before.count; f++) {
            size_t count = damages[n].apply(bytes, file_read(before.entries[f].path, bytes));
            file_write(before.entries[f].path, bytes, count);
        }
        extract_expect(damages[n].name);
        listing after = list(cache);
        EXPECT(names_same(&before, &after), "%s: %d files, %d before", damages[n].name, after.count, before.count);
        EXPECT(inodes_same(&before, &after) == 0, "%s: taken as it was", damages[n].name);
    }
}

/* Files that somebody else can write, or has written, are no good, whatever is in them. */
static void test_foreign_files(void) {
    const char *cache = cache_folder("deep/down/cache");
    const struct {
        const char *name;
        mode_t mode;
        uid_t owner;
    } cases[] = {{"files that the group may write", 0620, geteuid()},
                 {"files that all may write", 0602, geteuid()},
                 {"files of another user", 0600, 12345}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        listing before = list(cache);
        bool made = true;
        for (int f = 0; f < before.count; f++)
            made = made && !chmod(before.entries[f].path, cases[n].mode) &&
                   (cases[n].owner == geteuid() || !chown(before.entries[f].path, cases[n].owner, (gid_t)-1));
        if (!made) {
            printf("%s: not to be had without root\n", cases[n].name);
            continue;
        }
        extract_expect(cases[n].name);
        listing after = list(cache);
        EXPECT(names_same(&before, &after) && inodes_same(&before, &after) == 0, "%s: taken", cases[n].name);
    }
}

/* Files in a folder that others may write to are not used: damaged ones stay as they are. */
static void test_foreign_folders(void) {
    static char bytes[TEXT_MOST + 1];
    const char *cache = cache_folder("deep/down/cache");
    const mode_t modes[] = {0770, 0707, 0700};
    listing before = list(cache);
    for (int f = 0; f < before.count; f++) {
        size_t count = file_read(before.entries[f].path, bytes);
        file_write(before.entries[f].path, bytes, count ? last_spoil(bytes, count) : 0);
    }
    for (int n = 0; n < 3; n++) {
        const uid_t owner = n == 2 ? 12345 : geteuid();
        if (chmod(cache, modes[n]) || (owner != geteuid() && chown(cache, owner, (gid_t)-1))) continue;
        extract_expect("a folder of others");
        listing after = list(cache);
        EXPECT(names_same(&before, &after) && inodes_same(&before, &after) == 2, "a folder of mode %o, owner %d: used",
               (unsigned)modes[n], (int)owner);
    }
    EXPECT(!chmod(cache, 0700) && (geteuid() != 0 || !chown(cache, 0, (gid_t)-1)), "the folder cannot be put right");
    extract_expect("one's own folder again");
    listing after = list(cache);
    EXPECT(inodes_same(&before, &after) == 0, "damaged files were taken");
}

/* The file of one program under the name of the other. */
static void test_swapped(void) {
    char beside[PATH_MOST];
    listing before = list(cache_folder("deep/down/cache"));
    snprintf(beside, sizeof beside, "%s/beside", folder);
    EXPECT(!rename(before.entries[0].path, beside) && !rename(before.entries[1].path, before.entries[0].path) &&
               !rename(beside, before.entries[1].path),
           "files cannot be renamed");
    listing swapped = list(cache_folder("deep/down/cache"));
    extract_expect("swapped files");
    listing after = list(cache_folder("deep/down/cache"));
    EXPECT(names_same(&before, &after) && inodes_same(&swapped, &after) == 0, "a program went by another's name");
}

/* Folders in the files' places cannot be read, nor replaced. */
static void test_folders_for_files(void) {
    listing before = list(cache_folder("deep/down/cache"));
    for (int n = 0; n < before.count; n++)
        EXPECT(!unlink(before.entries[n].path) && !mkdir(before.entries[n].path, 0700), "no folder");
    extract_expect("folders for files");
    listing after = list(cache_folder("deep/down/cache"));
    EXPECT(names_same(&before, &after), "%d files are left beside the folders", after.count - before.count);
    for (int n = 0; n < before.count; n++) rmdir(before.entries[n].path);
}

static void test_unwritable(void) {
    char text[5000];
    snprintf(text, sizeof text, "%s/file", folder);
    file_write(text, "", 0);
    cache_folder("file/cache");
    extract_expect("a cache below a file");
    setenv("TETRACUBES_CACHE_DIR", "/proc/tetracubes", 1);
    extract_expect("a cache where no folder can be made");
    memset(text, 'a', sizeof text - 1);
    text[0] = '/';
    text[sizeof text - 1] = 0;
    setenv("TETRACUBES_CACHE_DIR", text, 1);
    extract_expect("a path too long");
    snprintf(text, sizeof text, "%s/locked", folder);
    mkdir(text, 0500);
    cache_folder("locked");
    extract_expect("a folder that is not to be written");
}

static void test_places(void) {
    char home[PATH_MOST], xdg[PATH_MOST], in_home[PATH_MOST + 32], in_xdg[PATH_MOST + 32];
    snprintf(home, sizeof home, "%s/home", folder);
    snprintf(xdg, sizeof xdg, "%s/xdg", folder);
    snprintf(in_home, sizeof in_home, "%s/.cache/tetracubes", home);
    snprintf(in_xdg, sizeof in_xdg, "%s/tetracubes", xdg);
    setenv("HOME", home, 1);
    setenv("XDG_CACHE_HOME", xdg, 1);
    setenv("TETRACUBES_CACHE_DIR", "", 1);
    extract_expect("a cache switched off");
    EXPECT(access(home, F_OK) && access(xdg, F_OK), "a cache switched off is written");
    unsetenv("TETRACUBES_CACHE_DIR");
    extract_expect("a cache in XDG_CACHE_HOME");
    EXPECT(list(in_xdg).count == 2 && access(home, F_OK), "%d files in XDG_CACHE_HOME", list(in_xdg).count);
    setenv("XDG_CACHE_HOME", "relative", 1);
    extract_expect("a relative XDG_CACHE_HOME");
    EXPECT(list(in_home).count == 2 && access("relative", F_OK), "%d files in HOME", list(in_home).count);
}

/* Each with kernels of the OpenCL implementation's own that are still to be built: where PoCL's processes share a cache
 * of PoCL's, they race in that. */
static void test_at_once(void) {
    enum { PROCESSES = 3 };
    pid_t children[PROCESSES];
    char pocl[PATH_MOST];
    const char *cache = cache_folder("shared");
    for (int n = 0; n < PROCESSES; n++) {
        snprintf(pocl, sizeof pocl, "%s/pocl-%d", folder, n);
        mkdir(pocl, 0700);
        setenv("POCL_CACHE_DIR", pocl, 1);
        children[n] = child_start(extract_compare);
    }
    for (int n = 0; n < PROCESSES; n++) {
        int status = child_end(children[n]);
        EXPECT(status == 0, "process %d of several at once: exit status %d", n, status);
    }
    listing first = list(cache);
    EXPECT(first.count == 2, "%d files for two programs", first.count);
    extract_expect("what several left");
    listing second = list(cache);
    EXPECT(names_same(&first, &second) && inodes_same(&first, &second) == 2, "what several left is no good");
}

int main(void) {
    samples_fill();
    setenv("TETRACUBES_CACHE_DIR", "", 1);
    if (child_end(child_start(device_look))) return SKIPPED;
    umask(022);
    folder_make("program-cache");
    test_second_process();
    test_damage();
    test_foreign_files();
    test_foreign_folders();
    test_swapped();
    test_folders_for_files();
    test_unwritable();
    test_places();
    test_at_once();
    folder_remove();
    return EXPECT_DONE();
}
