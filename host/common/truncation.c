#include "truncation.h"

#include "exit_status.h"
#include "failure.h"

#include <signal.h>
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

static volatile sig_atomic_t seen;
static uintptr_t page_bytes;

/* Compilers of kernels (LLVM) have handlers of their own while they work, which hand a fault of another thread on by
 * raising the signal anew: it comes again as a fault. Anything else that the signal may mean ends the process, as it
 * would without this. */
static void replace_page(int number, siginfo_t *about, void *context) {
    (void)context;
    void *page = (void *)((uintptr_t)about->si_addr & ~(page_bytes - 1)); // NOLINT(performance-no-int-to-ptr)
    if (about->si_code == BUS_ADRERR &&
        mmap(page, page_bytes, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) == page)
        seen = 1;
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

int truncation_seen(void) { return seen; }

void truncation_note(void) { seen = 1; }

int truncation_status(void) {
    return seen ? fail(STATUS_INPUT, "an input file became shorter while it was read: try again when it is complete")
                : 0;
}
