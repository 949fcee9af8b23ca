/*
 * labels.cl - the program of label maps: surfaces between labels (kernels/README.md)
 */
#include "label_classify.cl"
#include "label_emit.cl"
