/* truncation.c - see truncation.h */
#include "truncation.h"

#include "exit_status.h"
#include "failure.h"

#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

static volatile sig_atomic_t page_lost;
static uintptr_t page_bytes;

/* Compilers of kernels (LLVM) install handlers of their own while they work. These hand on a fault of another thread by
 * raising the signal anew (SI_TKILL); the fault itself then comes again. For any other reason the signal ends the
 * process, as it would without this handler. */
static void replace_page(int number, siginfo_t *about, void *context) {
    (void)context;
    void *page = (void *)((uintptr_t)about->si_addr & ~(page_bytes - 1)); // NOLINT(performance-no-int-to-ptr)
    if (about->si_code == BUS_ADRERR &&
        mmap(page, page_bytes, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) == page)
        page_lost = 1;
    else if (about->si_code != SI_TKILL || about->si_pid != getpid())
        signal(number, SIG_DFL);
}

void truncation_watch(void) {
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_sigaction = replace_page;
    action.sa_flags = SA_SIGINFO;
    page_bytes = (uintptr_t)sysconf(_SC_PAGESIZE);
    sigaction(SIGBUS, &action, NULL);
}

/* ---------------------------------------------------------------------------------------------------- watched files */

typedef struct watched {
    int file; /* a descriptor of our own: another file may get the name */
    const void *mapping;
    struct stat before;
    struct watched *next;
} watched;

static pthread_mutex_t watched_lock = PTHREAD_MUTEX_INITIALIZER;
static watched *watched_files;
static int changed;

void truncation_watch_file(int file, const void *mapping) {
    watched *w = calloc(1, sizeof *w);
    if (!w) return;
    w->file = fcntl(file, F_DUPFD_CLOEXEC, 3);
    w->mapping = mapping;
    if (w->file < 0 || fstat(w->file, &w->before)) {
        if (w->file >= 0) close(w->file);
        free(w);
        return;
    }
    pthread_mutex_lock(&watched_lock);
    w->next = watched_files;
    watched_files = w;
    pthread_mutex_unlock(&watched_lock);
}

static bool has_changed(const watched *w) {
    struct stat now;
    if (!fstat(w->file, &now) && now.st_size < w->before.st_size) page_lost = 1;
    return !fstat(w->file, &now) &&
           (now.st_size != w->before.st_size || now.st_mtim.tv_sec != w->before.st_mtim.tv_sec ||
            now.st_mtim.tv_nsec != w->before.st_mtim.tv_nsec);
}

void truncation_unwatch_file(const void *mapping) {
    pthread_mutex_lock(&watched_lock);
    watched **at = &watched_files;
    while (*at && (*at)->mapping != mapping) at = &(*at)->next;
    watched *found = *at;
    if (found) *at = found->next;
    if (found && has_changed(found)) changed = 1; /* what was read of it may be in use */
    pthread_mutex_unlock(&watched_lock);
    if (found) close(found->file);
    free(found);
}

static int change_seen(void) {
    pthread_mutex_lock(&watched_lock);
    for (const watched *w = watched_files; w && !changed; w = w->next) changed = has_changed(w);
    const int found = changed;
    pthread_mutex_unlock(&watched_lock);
    return found;
}

/* ---------------------------------------------------------------------------------------------------------- answers */

int truncation_seen(void) { return page_lost || change_seen(); }

void truncation_note(void) { page_lost = 1; }

int truncation_status(void) {
    if (page_lost)
        return fail(STATUS_INPUT, "an input file became shorter while it was read: try again when it is complete");
    if (change_seen())
        return fail(STATUS_INPUT, "an input file was written to while it was read: try again when it is complete");
    return 0;
}
