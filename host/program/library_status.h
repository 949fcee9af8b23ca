/* library_status.h - what a failure of the library means for a program: its exit status, and whether to trust the
 * driver
 */
#ifndef LIBRARY_STATUS_H
#define LIBRARY_STATUS_H

#include "tetracubes.h"

/* The exit status (exit_status.h) that a status of the library means; records tc_message() as the failure's text. */
int library_status(tc_status status);

/* Remembers that a driver has failed; the process should then end without letting it tidy up, which could crash or
 * hang. library_status does so where a device fails. From any thread. */
void driver_distrust(void);
int driver_is_distrusted(void);

#endif
