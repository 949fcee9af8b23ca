/* vtk_xml_absent.c - in place of the reader of VTK XML files, where this program is built without expat */
#include "exit_status.h"
#include "failure.h"
#include "read.h"
#include "readers.h"

int vtk_xml_read(const read_request *request, const mapping *file, dataset *out) {
    (void)file;
    (void)out;
    return fail(
        STATUS_INPUT,
        "%s: is VTK XML, which this program was built without (TETRACUBES_EXPAT); it reads %s, or save the file "
        "as VTK legacy (.vtk)",
        request->path, volume_formats());
}
