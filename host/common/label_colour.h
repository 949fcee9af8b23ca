/* label_colour.h - a colour of each label, the same in pictures, pages and files; viewer.html has it, too */
#ifndef LABEL_COLOUR_H
#define LABEL_COLOUR_H

#include <math.h>
#include <stdint.h>

/* sRGB, 0 to 1. Hues lie apart by the golden ratio of the circle, so that near labels have far ones. */
static inline void label_colour(uint32_t label, double out[3]) {
    const double turn = 6 * ((double)(label * 2654435769u) / 4294967296.0);
    for (int n = 0; n < 3; n++) {
        const double away = fabs(fmod(turn - 2 * n + 9, 6) - 3); /* from the hue of this component, 0 to 3 */
        const double strength = away < 1 ? 1 : away < 2 ? 2 - away : 0;
        out[n] = (110 + 130 * strength) / 255;
    }
}

#endif
