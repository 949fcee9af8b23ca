/*
 * complex.cl - all kernels of tetrahedral complexes, which are built as one program; where WHOLE is defined, those of
 * the cells that they were cut from
 */
#ifndef COMPLEX_CL
#define COMPLEX_CL

#include "complex_classify.cl"
#if WHOLE
#include "whole_list.cl"
#endif
#include "complex_join.cl"
#include "complex_number.cl"
#include "complex_emit.cl"

#endif
