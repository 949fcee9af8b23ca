/* exit_status.h - what the tool exits with; readers, writers and checks return the same numbers */
#ifndef EXIT_STATUS_H
#define EXIT_STATUS_H

enum exit_status {
    STATUS_DONE = 0,
    STATUS_FAILED = 1, /* could not: device, memory, output */
    STATUS_USAGE = 2,  /* options and their values */
    STATUS_CHECK = 3,  /* verification or check failed */
    STATUS_INPUT = 4,  /* bad input file, size mismatches included */
};

#endif
