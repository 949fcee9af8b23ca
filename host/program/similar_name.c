/*
 * similar_name.c - Damerau-Levenshtein distance (optimal string alignment), three rows of the usual table; a word that
 * is the beginning of the other is near to it
 *
 * Source: Damerau, "A technique for computer detection and correction of spelling errors" (1964).
 */
#include "similar_name.h"

#include <ctype.h>
#include <string.h>

#define LONGEST 63 /* longer names are compared by their beginnings */

static int least(int a, int b) { return a < b ? a : b; }

/* Insertions, deletions, replacements and swaps of neighbours, each 1. */
static int edit_distance(const char *a, const char *b) {
    int rows[3][LONGEST + 1];
    int *before = rows[0], *last = rows[1], *row = rows[2];
    int a_length = (int)strnlen(a, LONGEST), b_length = (int)strnlen(b, LONGEST);
    for (int j = 0; j <= b_length; j++) last[j] = j;
    for (int i = 1; i <= a_length; i++) {
        row[0] = i;
        for (int j = 1; j <= b_length; j++) {
            int replaced = last[j - 1] + (tolower((unsigned char)a[i - 1]) != tolower((unsigned char)b[j - 1]));
            row[j] = least(replaced, least(last[j], row[j - 1]) + 1);
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[j] = least(row[j], before[j - 2] + 1);
        }
        int *oldest = before;
        before = last;
        last = row;
        row = oldest;
    }
    return last[b_length];
}

const char *similar_name(const char *typed, const char *const *names, size_t count) {
    const char *best = NULL;
    int best_distance = LONGEST;
    for (size_t n = 0; n < count; n++) {
        if (!names[n]) continue;
        int distance = edit_distance(typed, names[n]);
        int beginning = *typed && strncmp(names[n], typed, strlen(typed)) == 0;
        if (beginning) distance = 1;
        if (distance > 2 && strlen(names[n]) > 4 && strncmp(typed, names[n], strlen(names[n])) == 0) distance = 2;
        if (distance < best_distance) {
            best = names[n];
            best_distance = distance;
        }
    }
    return best && best_distance <= 1 + (int)strnlen(best, LONGEST) / 3 ? best : NULL;
}
