/* shortest.h - numbers as text for people: the fewest digits that read back as the same number */
#ifndef SHORTEST_H
#define SHORTEST_H

typedef struct number_text {
    char text[32];
} number_text;

/* Of a double. To be used within the expression that calls it: printf("%s", shortest_number(value).text). */
number_text shortest_number(double value);

/* Of a coordinate: where a float holds it, the fewest digits that read back as the same float. */
number_text shortest_coordinate(double value);

#endif
