/* test_memory_left.c - how much memory a process may still take, by control groups that are planted and limits that are
 * set */
#include "expect.h"
#include "folder.h"
#include "host_memory.h"

#include <inttypes.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>

static const uint64_t none = UINT64_MAX;

/* A file of that text in the test's folder. */
static const char *plant(const char *name, const char *text) {
    static char path[600];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    EXPECT(file && fputs(text, file) >= 0, "%s: not written", path);
    if (file) fclose(file);
    return path;
}

static void plant_folder(const char *name) {
    char path[600];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    EXPECT(!mkdir(path, 0700), "%s: not made", path);
}

/* Of a process whose /proc/self/cgroup has that text. */
static void expect_left(const char *membership, uint64_t bytes) {
    const char *path = plant("membership", membership);
    char hierarchy[600];
    snprintf(hierarchy, sizeof hierarchy, "%s/groups", folder);
    const uint64_t left = group_memory_available(path, hierarchy);
    EXPECT(left == bytes, "%s: %" PRIu64 " bytes instead of %" PRIu64, membership, left, bytes);
}

static void test_group(void) {
    plant("groups/user/job/memory.max", "1000000\n");
    expect_left("0::/user/job\n", 1000000);
    plant("groups/user/job/memory.current", "700000\n");
    plant("groups/user/job/memory.stat", "anon 1\ninactive_anon 5\nactive_file 200000\nfile 7\ninactive_file 100000\n");
    expect_left("0::/user/job\n", 600000);
    expect_left("12:memory:/other\n1:name=systemd:/x\n0::/user/job\n", 600000); /* version 1 besides */
    plant("groups/user/job/memory.current", "1300001\n");
    expect_left("0::/user/job\n", 0); /* more than it may: the limit has come later */
    plant("groups/user/job/memory.max", "max\n");
    expect_left("0::/user/job\n", none);
}

static void test_around(void) {
    plant("groups/user/memory.max", "5000\n");
    plant("groups/user/memory.current", "1000\n");
    expect_left("0::/user/job\n", 4000);
    expect_left("0::/user\n", 4000);
    expect_left("0::/user/job/none\n", 4000); /* a group that is not shown */
    plant("groups/memory.max", "3000\n");     /* of a container, whose group is the root that it sees */
    expect_left("0::/user/job\n", 3000);
    expect_left("0::/\n", 3000);
    expect_left("0::/../job\n", 3000); /* as a process sees it that has been moved out of its namespace */
}

static void test_nothing_told(void) {
    char text[5000];
    expect_left("", none);
    expect_left("4:memory:/user/job\n", none); /* version 1 alone */
    expect_left("0::user\n", none);
    snprintf(text, sizeof text, "0::/%04500d\n", 0);
    expect_left(text, none);
    EXPECT(group_memory_available("/none", folder) == none, "a file that is not there");
}

static void test_limits(void) {
    const int limits[] = {RLIMIT_DATA, RLIMIT_AS};
    const uint64_t before = host_memory_available();
    EXPECT(before > 0 && before < none, "the system tells nothing: %" PRIu64, before);
    for (int n = 0; n < 2; n++) {
        struct rlimit kept, limit;
        EXPECT(!getrlimit(limits[n], &kept), "limit %d", n);
        limit = kept;
        limit.rlim_cur = 100 << 20;
        EXPECT(!setrlimit(limits[n], &limit), "limit %d", n);
        const uint64_t left = host_memory_available();
        EXPECT(left < 100 << 20, "limit %d: %" PRIu64, n, left);
        limit.rlim_cur = kept.rlim_max < (rlim_t)1 << 60 ? kept.rlim_max : (rlim_t)1 << 60;
        EXPECT(!setrlimit(limits[n], &limit), "limit %d", n);
        EXPECT(host_memory_available() > before / 2, "limit %d: a large one", n);
        EXPECT(!setrlimit(limits[n], &kept), "limit %d", n);
    }
}

int main(void) {
    folder_make("tetracubes-memory-left");
    plant_folder("groups");
    plant_folder("groups/user");
    plant_folder("groups/user/job");
    test_group();
    test_around();
    test_nothing_told();
    test_limits();
    folder_remove();
    return EXPECT_DONE();
}
