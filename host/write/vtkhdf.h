/* vtkhdf.h - the writer of VTKHDF, which programs have where they link mesh_write_hdf5 and ask for it (mesh_write.h) */
#ifndef VTKHDF_WRITER_H
#define VTKHDF_WRITER_H

#include "formats.h"

/* NULL: the format is refused. */
extern void (*vtkhdf_writer)(output *o, const shown_mesh *s);

#endif
