/*
 * complex.cl - all kernels of tetrahedral complexes, which are built as one program
 */
#ifndef COMPLEX_CL
#define COMPLEX_CL

#include "complex_classify.cl"
#include "complex_join.cl"
#include "complex_number.cl"
#include "complex_emit.cl"

#endif
