/*
 * main.c - finds the command, hands it its options, prints what went wrong
 *
 * Results go to standard output, everything else to standard error; exit statuses are those of exit_status.h.
 */
#include "command_line/completion.h"
#include "command_run.h"
#include "drivers/driver_trial.h"
#include "exit_status.h"
#include "failure.h"
#include "library_status.h"
#include "progress.h"
#include "selftest/child.h"
#include "similar_name.h"
#include "terminal/notice.h"
#include "terminal/standard_streams.h"
#include "truncation.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { COMMANDS_MOST = 16 };

static void print_overview(FILE *out) {
    fprintf(out, "tetracubes %s: isosurfaces of sampled volumes by marching tetrahedra, on OpenCL devices\n\n",
            tc_version());
    for (size_t n = 0; n < command_count; n++)
        fprintf(out, "  tetracubes %-14s %s\n", command_list[n].name, command_list[n].summary);
    fprintf(out, "\n"
                 "  tetracubes COMMAND --help   options and examples\n"
                 "  tetracubes --version        version and file formats\n"
                 "  tetracubes --completion S   completion for the shell S, bash or zsh\n"
                 "\n"
                 "A surface in three steps:\n"
                 "  tetracubes info volume.nrrd\n"
                 "  tetracubes extract volume.nrrd --iso 127.5 -o surface.ply\n"
                 "  tetracubes extract volume.nrrd --iso 127.5 --verify --check\n"
                 "\n"
                 "Environment: TETRACUBES_DEVICE, the device where --device is not given; TETRACUBES_CACHE_DIR,\n"
                 "the folder of built kernels (else $XDG_CACHE_HOME/tetracubes or ~/.cache/tetracubes; empty:\n"
                 "none); POCL_CACHE_DIR, that of PoCL itself.\n"
                 "\n"
                 "Exit status: 0 done; 1 could not (device, memory, output); 2 wrong usage; 3 verification or\n"
                 "check failed; 4 bad input file. Ctrl-C ends it by its signal.\n");
}

static int unknown_command(const char *name) {
    const char *names[COMMANDS_MOST] = {NULL};
    for (size_t n = 0; n < command_count; n++) names[n] = command_list[n].name;
    const char *meant = similar_name(name, names, command_count);
    if (meant) return fail(STATUS_USAGE, "there is no command '%s'; did you mean %s?", name, meant);
    return fail(STATUS_USAGE, "there is no command '%s'; see 'tetracubes --help'", name);
}

static int complete(const char *shell) {
    completion_command known[COMMANDS_MOST];
    for (size_t n = 0; n < command_count; n++)
        known[n] = (completion_command){command_list[n].name, command_list[n].summary, command_list[n].bit};
    return completion_print(shell, known, command_count, stdout);
}

static int dispatch(int argc, char **argv) {
    if (argc < 2) {
        print_overview(stderr);
        return fail(STATUS_USAGE, "which command?");
    }
    const char *name = argv[1];
    int wants_help = strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0 || strcmp(name, "help") == 0;
    if (wants_help && argc == 2) {
        print_overview(stdout);
        return 0;
    }
    if (strcmp(name, "--version") == 0) {
        version_print("tetracubes", stdout);
        return 0;
    }
    if (strcmp(name, "--completion") == 0)
        return argc == 3 ? complete(argv[2]) : fail(STATUS_USAGE, "--completion needs a shell: bash or zsh");
    if (strcmp(name, TRIAL_COMMAND) == 0 && argc == 3) return trial_child(argv[2]);
    if (strcmp(name, SELFTEST_COMMAND) == 0) return selftest_child(argc - 2, argv + 2);
    const command *c = command_find(wants_help ? argv[2] : name);
    if (!c) return unknown_command(wants_help ? argv[2] : name);
    if (!wants_help) return command_run(c, argc - 2, argv + 2, NULL);
    command_help(c, stdout);
    return 0;
}

/* After all is tidied up: a shell goes on with a loop where the tool exits by itself, and ends it where a signal ends
 * the tool. SIGQUIT and SIGXCPU would leave a core file. */
static void end_by_signal(int number) {
    if (number != SIGINT && number != SIGTERM && number != SIGHUP) return;
    signal(number, SIG_DFL);
    raise(number);
}

/* PoCL aborts the process where its variable is set, but empty. */
static void environment_mend(void) {
    const char *folder = getenv("POCL_CACHE_DIR");
    if (folder && !*folder) unsetenv("POCL_CACHE_DIR");
}

int main(int argc, char **argv) {
    environment_mend();
    truncation_watch(); /* before drivers start threads and put handlers of their own in front */
    writers_add();
    int status = dispatch(argc, argv);
    int is_written = fflush(stdout) == 0 && !ferror(stdout), error = errno;
    streams_restore();
    const int is_told = status && streams_has_failed();
    if (status) message("%s", failure_text());
    if (!is_written && !is_told) {
        const int lost = streams_fail(error);
        message("%s", failure_text());
        if (!status) status = lost;
    }
    if (status) end_by_signal(progress_cancelled());
    if (driver_is_distrusted()) _exit(status); /* it may crash or hang once more where it tidies up */
    return status;
}
