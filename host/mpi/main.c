/*
 * main.c - tetracubes-mpi: the tool's extract, by the ranks of an MPI job together
 *
 * Ranks own consecutive layers of the grid. Each reads its planes and a halo, counts, learns what lies before it from
 * an exclusive sum over the ranks, emits, and writes its pieces at their places in the one file. README.md says why
 * that is the file of one process, byte for byte.
 *
 * Rank 0 alone prints. A driver that is tried in a process of its own (TRIAL_COMMAND) is no part of the job.
 */
#include "command_run.h"
#include "commands.h"
#include "drivers/driver_trial.h"
#include "exit_status.h"
#include "failure.h"
#include "library_status.h"
#include "ranks.h"
#include "shared_device.h"
#include "terminal/notice.h"
#include "terminal/standard_streams.h"
#include "truncation.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static ranks job;
static char device[DEVICE_BYTES];
static int shared_devices; /* fewer than ranks, on some machine; 0: none */

/* What is right for the tool alone. */
static int check_options(const options *o) {
    if (o->part[1]) return fail(STATUS_USAGE, "--part is for processes that know nothing of each other: leave it out");
    return 0;
}

static int take_options(options *o, int status) {
    int count = 0;
    if (!status) status = check_options(o);
    if (!status && o->device) {
        status = shared_device_choose(o->device, job.node_rank, job.team.node_size, device, &count);
        o->device = device;
    }
    status = job.team.agree(&job.team, status);
    if (!status) shared_devices = ranks_largest(&job, count);
    if (job.team.rank) {
        o->quiet = 1;
        o->json = 0;
        if (o->help && !freopen("/dev/null", "w", stdout)) o->help = 0;
    }
    return status;
}

static int extract_by_ranks(const options *o) {
    if (shared_devices)
        notice("more ranks than devices: %d ranks of a machine share %d of those that --device names; start as many "
               "ranks as there are",
               job.team.node_size, shared_devices);
    return extract_run_together(o, &job.team);
}

static const char usage[] = "mpirun -np RANKS tetracubes-mpi extract INPUT... --iso V[,V...] [-o FILE] [options]";

static command extract_command(void) {
    command c = *command_find("extract");
    c.run = extract_by_ranks;
    c.usage = usage;
    c.text = "Extracts a surface as 'tetracubes extract' does, by the ranks of an MPI job together: each reads and\n"
             "contours planes of its own, and all write one file, to the byte that of one process. One\n"
             "structured grid; PLY, VTP, STL and VTKHDF. Options are those of the tool, but for what needs the\n"
             "whole mesh at once (--check, --verify, --soup, --drop-degenerate, --simplify, --preview) and\n"
             "--part. In --device, %r stands for the number of the rank on its machine, from 0.\n"
             "\n"
             "  mpirun -np 4 tetracubes-mpi extract ct.nrrd --iso 300 -o ct.ply\n"
             "  mpirun -np 4 tetracubes-mpi extract ct.nrrd --iso 300 -o ct.ply --device gpu:%r";
    return c;
}

static int run(int argc, char **argv) {
    const command c = extract_command();
    if (argc >= 2 && strcmp(argv[1], c.name) == 0) return command_run(&c, argc - 2, argv + 2, take_options);
    return fail(STATUS_USAGE, "tetracubes-mpi has one command: %s", usage);
}

/* Whether what needs no job was asked for and done: --help and --version, also where MPI cannot be started. Of ranks
 * that launchers number in the environment, the first prints. */
static int print_texts(int argc, char **argv) {
    const char *word = argc == 2 ? argv[1] : "", *numbers[] = {getenv("OMPI_COMM_WORLD_RANK"), getenv("PMI_RANK")};
    const int wants_help = strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0;
    const int wants_version = strcmp(word, "--version") == 0;
    const command c = extract_command();
    for (size_t n = 0; n < sizeof numbers / sizeof *numbers; n++)
        if (numbers[n] && strcmp(numbers[n], "0") != 0) return wants_help || wants_version;
    if (wants_help) command_help(&c, stdout);
    if (wants_version) version_print("tetracubes-mpi", stdout);
    return wants_help || wants_version;
}

int main(int argc, char **argv) {
    int provided;
    truncation_watch();
    writers_add();
    if (argc == 3 && strcmp(argv[1], TRIAL_COMMAND) == 0) return trial_child(argv[2]);
    if (print_texts(argc, argv)) return fflush(stdout) ? STATUS_FAILED : 0;
    MPI_Init_thread(&argc, &argv, MPI_THREAD_SERIALIZED, &provided); /* threads write in turn */
    ranks_begin(&job);
    int status = job.team.agree(&job.team, provided >= MPI_THREAD_SERIALIZED
                                               ? 0
                                               : fail(STATUS_FAILED, "this MPI takes no calls from several threads"));
    if (!status) status = run(argc, argv);
    if (fflush(stdout) && !status) status = fail(STATUS_FAILED, "standard output does not take the report");
    streams_restore();
    ranks_ending();
    if (status && job.team.rank == 0) message("%s", failure_text());
    MPI_Finalize();
    if (driver_is_distrusted()) _exit(status);
    return status;
}
