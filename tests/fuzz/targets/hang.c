/* hang.c - a timer of the process's own processor time; see hang.h */
#include "hang.h"

#include "check.h"

#include <signal.h>
#include <sys/time.h>
#include <unistd.h>

enum { MOST_SECONDS = 10 };

static void stop(int signal_number) {
    static const char text[] = "hang: an input takes more than 10 s of processor time\n";
    (void)signal_number;
    (void)!write(STDERR_FILENO, text, sizeof text - 1);
    abort();
}

void hang_watch(void) {
    static int is_set;
    const struct itimerval limit = {.it_value = {.tv_sec = MOST_SECONDS}};
    if (!is_set) CHECK(signal(SIGVTALRM, stop) != SIG_ERR);
    is_set = 1;
    CHECK(setitimer(ITIMER_VIRTUAL, &limit, NULL) == 0);
}
