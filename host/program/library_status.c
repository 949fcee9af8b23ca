#include "library_status.h"

#include "exit_status.h"
#include "failure.h"
#include "progress.h"

#include <stdatomic.h>

static atomic_int driver_has_failed;

void driver_distrust(void) { driver_has_failed = 1; }

int driver_is_distrusted(void) { return driver_has_failed; }

int library_status(tc_status status) {
    switch (status) {
    case TC_OK:
        return 0;
    case TC_ERROR_ARGUMENT:
        return fail(STATUS_USAGE, "%s", tc_message());
    case TC_ERROR_DATA:
        return fail(STATUS_INPUT, "%s", tc_message());
    case TC_ERROR_CANCELLED:
        return progress_cancelled() ? progress_status() : fail(STATUS_FAILED, "%s", tc_message());
    case TC_ERROR_DEVICE:
        driver_distrust();
        return fail(STATUS_FAILED, "%s", tc_message());
    default:
        return fail(STATUS_FAILED, "%s", tc_message());
    }
}
