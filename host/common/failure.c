/* failure.c - see failure.h */
#include "failure.h"

#include <stdarg.h>
#include <stdio.h>

static _Thread_local char text[1024];

int(fail)(int status, const char *format, ...) { /* no macro here */
    char fresh[sizeof text];                     /* arguments may point into the old text */
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(fresh, sizeof fresh, format, arguments);
    va_end(arguments);
    snprintf(text, sizeof text, "%s", fresh);
    return status;
}

const char *failure_text(void) { return text; }
