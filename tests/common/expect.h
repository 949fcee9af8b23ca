/*
 * expect.h - the whole of the test framework: a test is a main() of EXPECTs that returns EXPECT_DONE()
 *
 * EXPECT(condition, format, ...) prints file, line and text where the condition does not hold, and goes on. Tests of
 * many cases ask test_chosen(name) for each: TEST_ONLY in the environment, a pattern as of the shell's, leaves others
 * out. With TEST_STOP there the test ends at its first failure.
 */
#ifndef EXPECT_H
#define EXPECT_H

#include <fnmatch.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

static long expect_checks, expect_failures;

#define EXPECT(condition, ...)                                                                                         \
    do {                                                                                                               \
        expect_checks++;                                                                                               \
        if (!(condition)) {                                                                                            \
            expect_failures++;                                                                                         \
            printf("%s:%d: ", __FILE__, __LINE__);                                                                     \
            printf(__VA_ARGS__);                                                                                       \
            printf("\n");                                                                                              \
            if (getenv("TEST_STOP")) exit(EXIT_FAILURE);                                                               \
        }                                                                                                              \
    } while (0)

static inline bool test_chosen(const char *name) {
    const char *only = getenv("TEST_ONLY");
    return !only || !*only || !fnmatch(only, name, 0);
}

/* Prints the counts; nonzero where a check failed or none ran. */
#define EXPECT_DONE()                                                                                                  \
    (printf("%ld checks, %ld failed\n", expect_checks, expect_failures), expect_failures != 0 || expect_checks == 0)

#endif
