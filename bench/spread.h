/* spread.h - repeated measurements as median, minimum and maximum */
#ifndef SPREAD_H
#define SPREAD_H

typedef struct spread {
    double median, min, max;
} spread;

/* Sorts the values. All zeros where there are none. */
spread spread_of(double *values, int count);

#endif
