#include "output_group.h"

#include "exit_status.h"
#include "failure.h"

#include <errno.h>
#include <stdlib.h>
#include <sys/resource.h>

/* Every output that waits has a file open, its lock: as many as the system allows. */
static void allow_many_files(void) {
    struct rlimit files;
    if (getrlimit(RLIMIT_NOFILE, &files) != 0) return;
    files.rlim_cur = files.rlim_max;
    (void)setrlimit(RLIMIT_NOFILE, &files);
}

static int reserve_memory(output_group *group) {
    if (group->count < group->capacity) return 0;
    const size_t capacity = 2 * group->capacity + 1;
    output *grown = realloc(group->waiting, capacity * sizeof *grown);
    if (!grown) return ENOMEM;
    group->waiting = grown;
    group->capacity = capacity;
    return 0;
}

int output_wait(output *o, output_group *group) {
    output_finish(o);
    if (!o->error) o->error = reserve_memory(group);
    if (o->error || !o->temporary) return output_close(o);
    if (group->count == 0) allow_many_files();
    o->name = o->path;
    group->waiting[group->count++] = *o;
    return 0;
}

int output_group_publish(output_group *group) {
    int status = 0;
    for (size_t n = 0; n < group->count; n++) {
        if (status)
            output_discard(&group->waiting[n]);
        else
            status = output_close(&group->waiting[n]);
    }
    group->count = 0;
    output_group_discard(group);
    return status;
}

void output_group_discard(output_group *group) {
    for (size_t n = 0; n < group->count; n++) output_discard(&group->waiting[n]);
    free(group->waiting);
    *group = (output_group){0};
}
