/* The public header compiles after every header of the standard library, whose macros then are defined, and after those
 * of windows.h whose names a program may have taken over. test_header.py compiles this in several standards. */
#include <assert.h>
#include <complex.h>
#include <ctype.h>
#include <errno.h>
#include <fenv.h>
#include <float.h>
#include <inttypes.h>
#include <iso646.h>
#include <limits.h>
#include <locale.h>
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdalign.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <stdnoreturn.h>
#include <string.h>
#include <tgmath.h>
#include <threads.h>
#include <time.h>
#include <uchar.h>
#include <wchar.h>
#include <wctype.h>

#define near
#define far
#define small     char
#define hyper     long
#define interface struct
#define IN
#define OUT
#define OPTIONAL
#define min(a, b) ((a) < (b) ? (a) : (b))
#define max(a, b) ((a) > (b) ? (a) : (b))

#include "tetracubes.h"
#include "tetracubes.h" /* twice does no harm */

int main(void) { return tc_version() ? 0 : 1; }
