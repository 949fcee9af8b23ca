/* counted.h - a count with its noun as text for people: 0 triangles, 1 triangle, 2 triangles */
#ifndef COUNTED_H
#define COUNTED_H

#include <stdint.h>

typedef struct count_text {
    char text[72];
} count_text;

/* To be used within the expression that calls it: printf("%s", counted(count, "vertex", "vertices").text). */
count_text counted(uint64_t count, const char *one, const char *several);

#endif
