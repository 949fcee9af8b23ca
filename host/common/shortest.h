/* shortest.h - numbers as texts that can be typed back: the fewest digits that read back the same number */
#ifndef SHORTEST_H
#define SHORTEST_H

typedef struct number_text {
    char text[32];
} number_text;

/* Of a double. To be used within the expression that calls it: printf("%s", shortest_number(value).text). */
number_text shortest_number(double value);

/* Likewise of a coordinate that a float holds: the fewest digits that read back the same float. */
number_text shortest_coordinate(double value);

#endif
