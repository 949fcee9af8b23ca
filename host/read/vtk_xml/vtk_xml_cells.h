/* vtk_xml_cells.h - the cells of an unstructured piece: types, points, faces of polyhedra */
#ifndef VTK_XML_CELLS_H
#define VTK_XML_CELLS_H

#include "vtk_xml/vtk_xml_load.h"

/* Fills the block's cells; it has its points. */
int vtk_xml_load_cells(xml_reader *r, const xml_piece *piece, dataset_block *block);

#endif
