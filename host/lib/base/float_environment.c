#include "base/float_environment.h"

#include <stdbool.h>
#include <stddef.h>

static _Thread_local float_environment *innermost;

/* On x86 most callers have the default environment; then only its flags are saved, as saving the whole environment
 * takes half a microsecond. Nothing here raises x87 flags. C does not define flushing of subnormal numbers, so setting
 * its default environment need not end it. */
#ifdef __SSE2_MATH__
#include <xmmintrin.h>

static bool control_is_default(float_environment *e) {
    const unsigned default_sse = 0x1f80, flags = 0x3f;
    unsigned short x87, default_x87 = 0x37f;
    __asm__ volatile("fnstcw %0" : "=m"(x87));
    e->sse = _mm_getcsr();
    return (e->sse & ~flags) == default_sse && x87 == default_x87;
}

static void sse_set(unsigned control) { _mm_setcsr(control); }

static void flushing_end(void) { _mm_setcsr(_mm_getcsr() & ~0x8040u); }
#else
static bool control_is_default(float_environment *e) { return e->sse = 0, false; }

static void sse_set(unsigned control) { (void)control; }

static void flushing_end(void) {}
#endif

static void callers_keep(float_environment *e) {
    e->is_default = control_is_default(e);
    if (e->is_default) return;
    fegetenv(&e->callers);
    fesetenv(FE_DFL_ENV);
    flushing_end();
}

static void callers_restore(const float_environment *e) {
    if (e->is_default)
        sse_set(e->sse);
    else
        fesetenv(&e->callers);
}

void float_environment_enter(float_environment *e) {
    callers_keep(e);
    e->outer = innermost;
    innermost = e;
}

void float_environment_leave(float_environment *e) {
    innermost = e->outer;
    callers_restore(e);
}

static float_environment *outermost(float_environment *e) {
    while (e->outer) e = e->outer;
    return e;
}

/* Public calls within the lent-to function do not nest in this call: the function is their caller. */
float_environment *float_environment_lend(void) {
    float_environment *lent = innermost;
    innermost = NULL;
    if (lent) callers_restore(outermost(lent));
    return lent;
}

void float_environment_resume(float_environment *lent) {
    innermost = lent;
    if (lent) callers_keep(outermost(lent));
}
