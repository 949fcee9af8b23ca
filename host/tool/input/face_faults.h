/*
 * face_faults.h - how the cells of unstructured blocks meet: checked on the tetrahedra that they are cut into
 *
 * Every unstructured cell is oriented by its own volume, so that neighbours that overlap contradict each other. A
 * structured block is oriented as a whole: its tetrahedra fit, folded or not.
 */
#ifndef FACE_FAULTS_H
#define FACE_FAULTS_H

#include "blocks.h"
#include "complex_check.h"

/* Sums over the blocks. isovalue NULL: of all faces; else of those that the surface crosses. */
int face_faults_find(const block_list *list, const double *isovalue, complex_faces *sum);

/* Tells on standard error what is wrong with the faces of all blocks. */
void face_faults_tell(const complex_faces *faces);

#endif
