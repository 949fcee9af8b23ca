/* test_vtk_xml_hostile.c - VTK XML files that are wrong, or odd: what is said of each */
#include "exit_status.h"
#include "expect.h"
#include "failure.h"
#include "vtk_xml_files.h"

/* ------------------------------------------------------------------------------------------------------ small files */

static void expect_refused(const char *words, const char *text) {
    dataset d;
    int status = read_path(file_text("bad.vtk", text), &d);
    EXPECT(status == STATUS_INPUT && strstr(failure_text(), words) && strstr(failure_text(), "bad.vtk"),
           "status %d, text lacks '%s': %s\n%.300s", status, words, failure_text(), text);
    dataset_release(&d);
}

#define FILE_OF(type, attributes, content) "<VTKFile type=\"" type "\"" attributes ">" content "</VTKFile>"
#define IMAGE(extent, content)                                                                                         \
    FILE_OF("ImageData", "", "<ImageData><Piece Extent=\"" extent "\">" content "</Piece></ImageData>")
#define POINTS(attributes, content)                                                                                    \
    "<PointData><DataArray Name=\"a\" " attributes ">" content "</DataArray></PointData>"
#define CELLS(points, cells, connectivity, offsets, types)                                                             \
    FILE_OF("UnstructuredGrid", "",                                                                                    \
            "<UnstructuredGrid><Piece NumberOfPoints=\"" points "\" NumberOfCells=\"" cells "\"><Points><DataArray "   \
            "type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points>"  \
            "<Cells><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">" connectivity                    \
            "</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">" offsets                         \
            "</DataArray><DataArray type=\"Int16\" Name=\"types\" format=\"ascii\">" types                             \
            "</DataArray></Cells></Piece></UnstructuredGrid>")
#define CUBE "0 1 0 1 0 1"

static void test_kinds_refused(void) {
    expect_refused("PolyData", FILE_OF("PolyData", "", "<PolyData/>"));
    expect_refused("list of other files", FILE_OF("PImageData", "", ""));
    expect_refused("list of other files", FILE_OF("PUnstructuredGrid", "", ""));
    expect_refused("list of other files", FILE_OF("vtkMultiBlockDataSet", "", ""));
    expect_refused("HyperTreeGrid", FILE_OF("HyperTreeGrid", "", ""));
    expect_refused(".vtu", "<VTKFile version=\"0.1\"/>");
    expect_refused("not VTKFile", "<svg/>");
    expect_refused("is not XML", "# vtk DataFile Version 3.0\n");
    expect_refused("is not XML", "<VTKFile type=\"ImageData\"><ImageData></VTKFile>");
    expect_refused("is empty", "");
    expect_refused("no points", FILE_OF("ImageData", "", "<ImageData/>"));
    expect_refused("no points", FILE_OF("ImageData", "", ""));
    expect_refused("no points", IMAGE("0 -1 0 -1 0 -1", ""));
    expect_refused("byte_order", FILE_OF("ImageData", " byte_order=\"Middle\"", ""));
    expect_refused("header_type", FILE_OF("ImageData", " header_type=\"UInt16\"", ""));
}

/* Expat must not even see entities; deep elements and long texts must not matter. */
static void test_xml(void) {
    expect_refused("document type", "<!DOCTYPE a [<!ENTITY b \"bbbbbbbb\"><!ENTITY c \"&b;&b;&b;&b;\">]><a>&c;</a>");
    expect_refused("document type", "<!DOCTYPE VTKFile SYSTEM \"file:///etc/passwd\"><VTKFile type=\"ImageData\"/>");
    bytes deep = {0};
    bytes_text(&deep, "<VTKFile type=\"ImageData\"><ImageData>");
    for (int i = 0; i < 3000; i++) bytes_text(&deep, "<Piece>");
    bytes_add(&deep, "", 1);
    expect_refused("Extent", (char *)deep.data);
    deep.size = 0;
    bytes_text(&deep, "<VTKFile type=\"ImageData\">");
    for (int i = 0; i < 3000; i++) bytes_text(&deep, "<a>");
    bytes_add(&deep, "", 1);
    expect_refused("nested", (char *)deep.data);
    bytes_free(&deep);
}

static void test_extents(void) {
    expect_refused("Extent", FILE_OF("ImageData", "", "<ImageData><Piece/></ImageData>"));
    expect_refused("Extent", IMAGE("0 1 0 1", ""));
    expect_refused("Extent", IMAGE("0 1 0 1 0 1 0", ""));
    expect_refused("Extent", IMAGE("0 1 0 1 5 0", ""));
    expect_refused("Extent", IMAGE("0 1 0 1 0 x", ""));
    expect_refused("Extent", IMAGE("0 1 0 1 0 99999999999999999999", ""));
    expect_refused("Extent", IMAGE("0 1 0 1 -9223372036854775808 1", ""));
    expect_refused("too many points", IMAGE("0 2147483646 0 2147483646 0 2147483646", ""));
    expect_refused("too many points", IMAGE("-2147483648 2147483647 -2147483648 2147483647 0 1", ""));
    expect_refused("numbers of text",
                   IMAGE("0 2000000 0 2000000 0 100", POINTS("type=\"UInt8\" format=\"ascii\"", "1 2 3")));
    expect_refused("Spacing", FILE_OF("ImageData", "", "<ImageData Spacing=\"1 1\"/>"));
    expect_refused("Direction", FILE_OF("ImageData", "", "<ImageData Direction=\"1 0 0 0 1 0 0 0\"/>"));
    expect_refused("do not span",
                   FILE_OF("ImageData", "", "<ImageData Spacing=\"1 0 1\"><Piece Extent=\"" CUBE "\"/></ImageData>"));
    expect_refused("not finite",
                   FILE_OF("ImageData", "", "<ImageData Origin=\"1 nan 1\"><Piece Extent=\"" CUBE "\"/></ImageData>"));
}

static void test_arrays(void) {
    expect_refused("format", IMAGE(CUBE, POINTS("type=\"UInt8\" format=\"hex\"", "")));
    expect_refused("NumberOfComponents", IMAGE(CUBE, POINTS("type=\"UInt8\" NumberOfComponents=\"0\"", "")));
    expect_refused("NumberOfComponents", IMAGE(CUBE, POINTS("type=\"UInt8\" NumberOfComponents=\"9999999999\"", "")));
    expect_refused("offset", IMAGE(CUBE, POINTS("type=\"UInt8\" format=\"appended\"", "")));
    expect_refused("offset", IMAGE(CUBE, POINTS("type=\"UInt8\" format=\"appended\" offset=\"-1\"", "")));
    expect_refused("of which the file has none", IMAGE(CUBE, POINTS("type=\"UInt8\" offset=\"0\"", "")));
    expect_refused("'300'", IMAGE(CUBE, POINTS("type=\"UInt8\"", "1 2 3 4 5 6 7 300")));
    expect_refused("'-129'", IMAGE(CUBE, POINTS("type=\"Int8\"", "1 2 3 4 5 6 -128 -129")));
    expect_refused("'-1'", IMAGE(CUBE, POINTS("type=\"UInt32\"", "1 2 3 4 5 6 7 -1")));
    expect_refused("'1.5'", IMAGE(CUBE, POINTS("type=\"Int32\"", "1 2 3 4 5 6 7 1.5")));
    expect_refused("'1.5x'", IMAGE(CUBE, POINTS("type=\"Float32\"", "1 2 3 4 5 6 7 1.5x")));
    expect_refused("'9223372036854775808'", IMAGE(CUBE, POINTS("type=\"Int64\"", "1 2 3 4 5 6 7 9223372036854775808")));
    expect_refused("has 7 numbers", IMAGE(CUBE, POINTS("type=\"Int32\"", "10 20 3 4 5 6 7")));
    expect_refused("has at most", IMAGE(CUBE, POINTS("type=\"Int32\"", "1 2 3 4")));
    expect_refused("has at most", IMAGE(CUBE, POINTS("type=\"Int32\"", "")));
    expect_refused("several parts", IMAGE(CUBE, POINTS("type=\"Int32\"", "1 2 3 4 <a/> 5 6 7 8")));
    expect_refused("'a' ends", IMAGE(CUBE, POINTS("type=\"Int32\" format=\"binary\"", "IAA")));
    expect_refused("'a' ends", IMAGE(CUBE, POINTS("type=\"Int32\" format=\"binary\"", "*AAA")));
    expect_refused("has 32 bytes", IMAGE(CUBE, POINTS("type=\"Int64\" format=\"binary\"", "IAAAAAAAAAAA")));
    expect_refused("vtkLZ5DataCompressor",
                   FILE_OF("ImageData", " compressor=\"vtkLZ5DataCompressor\"",
                           "<ImageData><Piece Extent=\"" CUBE
                           "\">" POINTS("type=\"UInt8\" format=\"binary\"", "AAAA") "</Piece></ImageData>"));
    expect_refused("begin with '_'",
                   FILE_OF("ImageData", "",
                           "<ImageData><Piece Extent=\"" CUBE
                           "\">" POINTS("type=\"UInt8\" offset=\"0\"",
                                        "") "</Piece></ImageData><AppendedData encoding=\"raw\">AAAA</AppendedData>"));
    expect_refused("only", FILE_OF("ImageData", "",
                                   "<ImageData><Piece Extent=\"" CUBE "\">" POINTS(
                                       "type=\"UInt8\" offset=\"1000\"",
                                       "") "</Piece></ImageData><AppendedData encoding=\"raw\">_AAAA</AppendedData>"));
}

/* Headers of compressed data: blocks, bytes of one, bytes of the last, then packed bytes; 32 bits each. */
static void expect_packed_refused(const char *compressor, const char *words, const uint32_t *header, size_t count) {
    bytes raw = {0}, file = {0};
    for (size_t i = 0; i < count; i++) bytes_put(&raw, header[i], 4, 0);
    bytes_add(&raw, "some bytes that are nothing that was packed", 43);
    bytes_text(&file,
               "<VTKFile type=\"ImageData\" byte_order=\"LittleEndian\" compressor=\"vtk%sDataCompressor\">"
               "<ImageData><Piece Extent=\"0 99 0 99 0 99\">" POINTS("type=\"UInt8\" format=\"binary\"", ""),
               compressor);
    file.size -= strlen("</DataArray></PointData>");
    add_base64(&file, &raw, 0);
    bytes_text(&file, "</DataArray></PointData></Piece></ImageData></VTKFile>");
    bytes_add(&file, "", 1);
    expect_refused(words, (char *)file.data);
    bytes_free(&raw);
    bytes_free(&file);
}

static void expect_blocks_refused(const char *words, const uint32_t *header, size_t count) {
    expect_packed_refused("ZLib", words, header, count);
    expect_packed_refused("LZ4", can_pack(BY_LZ4) ? words : "", header, count);
    expect_packed_refused("LZMA", can_pack(BY_LZMA) ? words : "", header, count);
}

/* Reads eight values of a byte, in one block that is packed so. */
static int read_packed(const char *compressor, const bytes *block, dataset *d) {
    const uint32_t sizes[] = {1, 8, 0, (uint32_t)block->size};
    bytes raw = {0}, file = {0};
    for (int n = 0; n < 4; n++) bytes_put(&raw, sizes[n], 4, 0);
    bytes_add(&raw, block->data, block->size);
    bytes_text(&file,
               "<VTKFile type=\"ImageData\" compressor=\"vtk%sDataCompressor\"><ImageData><Piece Extent=\"" CUBE "\">"
               "<PointData><DataArray Name=\"a\" type=\"UInt8\" format=\"binary\">",
               compressor);
    add_base64(&file, &raw, 0);
    bytes_text(&file, "</DataArray></PointData></Piece></ImageData></VTKFile>");
    int status = read_bytes("packed.vtk", &file, d);
    bytes_free(&raw);
    bytes_free(&file);
    return status;
}

/* A block of LZMA that asks for a dictionary of 4 GiB; else a good one. */
static void test_dictionary(void) {
#ifdef HAVE_LZMA
    for (int huge = 0; huge < 2; huge++) {
        const unsigned char zeros[8] = {0};
        bytes block = packed_block(BY_LZMA, zeros, sizeof zeros);
        dataset d;
        unsigned char *header = block.data + 12, *at = header + 2; /* behind the header of the stream; the flags */
        size_t checked = 4 * (size_t)header[0];
        for (int n = 6; n < 8; n++) /* two optional sizes, of 7 bits in each byte */
            if (header[1] >> n & 1)
                while (*at++ & 0x80) {
                }
        EXPECT(at[0] == 0x21 && at[1] == 1, "no filter LZMA2 in the header of the block");
        if (huge) at[2] = 40;
        uint32_t sum = lzma_crc32(header, checked, 0);
        memcpy(header + checked, &sum, sizeof sum);
        int status = read_packed("LZMA", &block, &d);
        EXPECT(huge ? status == STATUS_INPUT && strstr(failure_text(), "dictionary of more") : status == 0,
               "dictionary, huge %d: status %d: %s", huge, status, failure_text());
        dataset_release(&d);
        bytes_free(&block);
    }
#endif
}

/* Blocks that hold fewer bytes than their array needs, as many, and more. */
static void test_short_blocks(void) {
    static const char *const compressors[] = {"", "ZLib", "LZ4", "LZMA"};
    const unsigned char values[9] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
    for (int by = BY_ZLIB; by <= BY_LZMA; by++)
        for (size_t size = 7; size <= 9 && can_pack(by); size++) {
            bytes block = packed_block(by, values, size);
            dataset d;
            int status = read_packed(compressors[by], &block, &d);
            EXPECT(status == (size < 8 ? STATUS_INPUT : 0), "%s, %zu of 8 bytes: status %d: %s", compressors[by], size,
                   status, failure_text());
            EXPECT(status || !memcmp(d.blocks[0].fields[0].values, values, 8), "%s, %zu of 8 bytes: others",
                   compressors[by], size);
            dataset_release(&d);
            bytes_free(&block);
        }
}

static void test_blocks(void) {
    test_dictionary();
    test_short_blocks();
    expect_blocks_refused("ends", (uint32_t[]){0xffffffff, 1000000, 0, 10}, 4);
    expect_blocks_refused("ends", (uint32_t[]){1, 1000000, 0, 0xffffffff}, 4);
    expect_blocks_refused("ends", (uint32_t[]){2, 500000, 0, 40, 40}, 5);
    expect_blocks_refused("has 0 bytes", (uint32_t[]){0, 1000000, 0}, 3);
    expect_blocks_refused("has 0 bytes", (uint32_t[]){1, 0, 0, 10}, 4);
    expect_blocks_refused("has 999999 bytes", (uint32_t[]){1, 1000000, 999999, 10}, 4);
    expect_blocks_refused("make no sense", (uint32_t[]){1, 1000000, 1000001, 10}, 4);
    expect_blocks_refused("cannot hold more", (uint32_t[]){1, 1000000, 0, 40}, 4);
    expect_blocks_refused("cannot hold more", (uint32_t[]){1, 0xffffffff, 0, 40}, 4);
}

static void test_cells(void) {
    dataset d;
    EXPECT(read_path(file_text("cells.vtk", CELLS("4", "1", "0 1 2 3", "4", "10")), &d) == 0, "%s", failure_text());
    dataset_release(&d);
    expect_refused("point 4", CELLS("4", "1", "0 1 2 4", "4", "10"));
    expect_refused("point -1", CELLS("4", "1", "0 1 2 -1", "4", "10"));
    expect_refused("ascend", CELLS("4", "2", "0 1 2 3", "4 3", "10 10"));
    expect_refused("ascend", CELLS("4", "1", "0 1 2 3", "-4", "10"));
    expect_refused("'connectivity' has at most", CELLS("4", "1", "0 1 2 3", "5", "10"));
    expect_refused("'connectivity'", CELLS("4", "1", "0 1 2 3", "9223372036854775807", "10"));
    expect_refused("type 300", CELLS("4", "1", "0 1 2 3", "4", "300"));
    expect_refused("'types' has at most", CELLS("4", "1", "0 1 2 3", "4", ""));
    expect_refused("has at most", CELLS("4", "99999999999", "0 1 2 3", "4", "10"));
    expect_refused("of Points", CELLS("5", "1", "0 1 2 3", "4", "10"));
    expect_refused("of Points", CELLS("99999999999999999", "1", "0 1 2 3", "4", "10"));
    expect_refused("NumberOfPoints", CELLS("-1", "1", "0 1 2 3", "4", "10"));
    expect_refused("NumberOfCells", CELLS("4", "9223372036854775807", "0 1 2 3", "4", "10"));
    expect_refused("Points", FILE_OF("UnstructuredGrid", "",
                                     "<UnstructuredGrid><Piece NumberOfPoints=\"1\" NumberOfCells=\"0\"/>"
                                     "</UnstructuredGrid>"));
    expect_refused("floating", FILE_OF("UnstructuredGrid", "",
                                       "<UnstructuredGrid><Piece NumberOfPoints=\"1\" NumberOfCells=\"1\"><Points>"
                                       "<DataArray type=\"UInt8\" NumberOfComponents=\"3\">1 2 3</DataArray></Points>"
                                       "<Cells><DataArray type=\"UInt8\" Name=\"types\">1</DataArray><DataArray "
                                       "type=\"Float32\" Name=\"offsets\">1</DataArray><DataArray type=\"UInt8\" "
                                       "Name=\"connectivity\">0</DataArray></Cells></Piece></UnstructuredGrid>"));
    expect_refused("no array 'types'",
                   FILE_OF("UnstructuredGrid", "",
                           "<UnstructuredGrid><Piece NumberOfPoints=\"1\" NumberOfCells=\"1\"><Points><DataArray "
                           "type=\"UInt8\" NumberOfComponents=\"3\">1 2 3</DataArray></Points></Piece>"
                           "</UnstructuredGrid>"));
    expect_refused("Coordinates", FILE_OF("RectilinearGrid", "",
                                          "<RectilinearGrid><Piece Extent=\"" CUBE "\"><Coordinates><DataArray "
                                          "type=\"UInt8\">1 2</DataArray></Coordinates></Piece></RectilinearGrid>"));
}

#define POLYHEDRON(arrays) POLYHEDRON_OF("0 1 2 3 0 1 2 3 2 3", arrays)
#define POLYHEDRON_OF(connectivity, arrays)                                                                            \
    FILE_OF("UnstructuredGrid", "",                                                                                    \
            "<UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"3\"><Points><DataArray type=\"Float32\" "   \
            "NumberOfComponents=\"3\">0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points><Cells>" INTEGERS(                   \
                "connectivity", connectivity) INTEGERS("offsets", "4 8 10") INTEGERS("types", "10 42 3") arrays        \
            "</Cells></Piece></UnstructuredGrid>")
#define INTEGERS(name, values)  "<DataArray type=\"Int64\" Name=\"" name "\">" values "</DataArray>"
#define STREAM                  "4 3 0 1 2 3 0 1 3 3 3 1 2 3 0 2 3"
#define OLD_FACES(ends, stream) POLYHEDRON(INTEGERS("faceoffsets", ends) INTEGERS("faces", stream))
#define NEW_FACES(cells, faces, ends, points)                                                                          \
    POLYHEDRON(INTEGERS("polyhedron_offsets", cells) INTEGERS("polyhedron_to_faces", faces)                            \
                   INTEGERS("face_offsets", ends) INTEGERS("face_connectivity", points))

static void expect_faces(const char *what, const char *text, const int64_t *first_face) {
    static const int64_t starts[] = {0, 0, 4, 4}, offsets[] = {0, 3, 6, 9, 12};
    dataset d;
    int status = read_path(file_text("faces.vtk", text), &d);
    const dataset_block *b = d.blocks;
    EXPECT(status == 0, "%s: %s", what, failure_text());
    EXPECT(status || (b->cell_faces && !memcmp(b->cell_faces, starts, sizeof starts) &&
                      !memcmp(b->face_offsets, offsets, sizeof offsets) &&
                      !memcmp(b->face_points, first_face, 3 * sizeof *first_face)),
           "%s: the faces differ", what);
    dataset_release(&d);
}

/* The two layouts that VTK has written. */
static void test_faces(void) {
    expect_faces("old", OLD_FACES("-1 17 -1", STREAM), (const int64_t[]){0, 1, 2});
    expect_faces("new", NEW_FACES("0 4 4", "3 1 2 0", "3 6 9 12", "0 1 2 0 1 3 3 1 2 0 2 3"),
                 (const int64_t[]){0, 2, 3});
    expect_refused("do not fit", OLD_FACES("-1 16 -1", STREAM));
    expect_refused("'faces' has at most", OLD_FACES("-1 30 -1", STREAM));
    expect_refused("'faces' has at most", OLD_FACES("-1 9223372036854775 -1", STREAM));
    expect_refused("do not fit", OLD_FACES("-1 -1 -1", STREAM));
    expect_refused("do not fit", OLD_FACES("-1 17 -1", "4 3 0 1 2 3 0 1 3 3 3 1 2 4 0 2 3"));
    expect_refused("has the point 4", OLD_FACES("-1 17 -1", "4 3 0 1 2 3 0 1 3 3 3 1 2 3 0 2 4"));
    expect_refused("no array 'faces'", POLYHEDRON(INTEGERS("faceoffsets", "-1 17 -1")));
    expect_refused("no array 'polyhedron_to_faces'", POLYHEDRON(INTEGERS("polyhedron_offsets", "0 4 4")));
    expect_refused("the numbers", NEW_FACES("0 4 3", "3 1 2 0", "3 6 9 12", "0 1 2 0 1 3 3 1 2 0 2 3"));
    expect_refused("the numbers", NEW_FACES("-1 4 4", "3 1 2 0", "3 6 9 12", "0 1 2 0 1 3 3 1 2 0 2 3"));
    expect_refused("the numbers", NEW_FACES("0 4 4", "3 1 -2 0", "3 6 9 12", "0 1 2 0 1 3 3 1 2 0 2 3"));
    expect_refused("the offsets", NEW_FACES("0 4 4", "3 1 2 0", "3 2 9 12", "0 1 2 0 1 3 3 1 2 0 2 3"));
    expect_refused("'face_offsets'", NEW_FACES("0 4 4", "3 1 2 9223372036854775807", "3 6 9 12", "0 1 2"));
    expect_refused("'polyhedron_to_faces'", NEW_FACES("0 4 9223372036854775807", "3 1 2 0", "3 6 9 12", "0 1 2"));
    expect_refused("'face_connectivity'", NEW_FACES("0 4 4", "3 1 2 0", "3 6 9 120", "0 1 2"));
    expect_refused("has the point 4", NEW_FACES("0 4 4", "3 1 2 0", "3 6 9 12", "0 1 2 0 1 3 3 1 2 0 2 4"));
    dataset d;
    EXPECT(read_path(file_text("none.vtk", POLYHEDRON("")), &d) == 0 && !d.blocks[0].cell_faces, "%s", failure_text());
    dataset_release(&d);
}

/* One face in cells by the ten thousand. */
static void test_shared_faces(void) {
    enum { CELLS_MADE = 20000, CORNERS = 20000 };
    bytes file = {0};
    dataset d;
    bytes_text(&file,
               "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"1\" NumberOfCells=\"%d\">"
               "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\">0 0 0</DataArray></Points><Cells>",
               CELLS_MADE);
    static const char *const names[] = {"types", "offsets", "polyhedron_offsets", "polyhedron_to_faces",
                                        "face_connectivity"};
    bytes_text(&file, INTEGERS("connectivity", "") INTEGERS("face_offsets", "20000"));
    for (int n = 0; n < 5; n++) {
        bytes_text(&file, "<DataArray type=\"Int32\" Name=\"%s\">", names[n]);
        for (int i = 0; i < CELLS_MADE; i++) bytes_text(&file, "%d ", n == 0 ? 42 : n == 2 ? i + 1 : 0);
        bytes_text(&file, "</DataArray>");
    }
    bytes_text(&file, "</Cells></Piece></UnstructuredGrid></VTKFile>");
    EXPECT(CORNERS == CELLS_MADE && read_bytes("shared.vtk", &file, &d) == STATUS_INPUT &&
               strstr(failure_text(), "too many of its polyhedra"),
           "%s", failure_text());
    dataset_release(&d);
    bytes_free(&file);
}

/* Many arrays that share one, each of which would be unpacked. */
static void test_sharing(void) {
    bytes file = {0};
    bytes_text(&file,
               "<VTKFile type=\"ImageData\" byte_order=\"LittleEndian\"><ImageData><Piece Extent=\"0 19 0 19 0 49\">"
               "<PointData>");
    for (int i = 0; i < 1000; i++) bytes_text(&file, "<DataArray type=\"Int8\" Name=\"%d\" offset=\"0\"/>", i);
    bytes_text(&file, "</PointData></Piece></ImageData><AppendedData encoding=\"base64\">_");
    bytes data = {0};
    unsigned char *values = calloc(20000, 1);
    bytes_put(&data, 20000, 4, 0);
    bytes_add(&data, values, 20000);
    free(values);
    add_base64(&file, &data, 0);
    dataset d;
    EXPECT(read_bytes("shared.vtk", &file, &d) == STATUS_INPUT && strstr(failure_text(), "share"), "%s",
           failure_text());
    dataset_release(&d);
    bytes_free(&data);
    bytes_free(&file);
}

/* ---------------------------------------------------------------------------------------------------------- notices */

static void test_notices(void) {
    dataset d;
    const char *wide =
        IMAGE(CUBE, POINTS("type=\"Int64\"", "1 2 3 4 5 6 7 9007199254740993") "<CellData><DataArray type=\"UInt8\" "
                                                                               "Name=\"c\">7</DataArray></CellData>");
    EXPECT(read_path(file_text("wide.vtk", wide), &d) == 0 && !d.notice_count, "%s, notice '%s'", failure_text(),
           d.notice);
    EXPECT(d.block_count == 1 && d.blocks[0].field_count == 2 && d.blocks[0].fields[0].is_rounded &&
               !d.blocks[0].fields[1].is_rounded && field_value(&d.blocks[0].fields[0], 7) == 0x1p53 &&
               field_value(&d.blocks[0].fields[0], 6) == 7,
           "fields");
    dataset_release(&d);

    const char *more = IMAGE(CUBE, POINTS("type=\"Int16\"", "1 2 3 4 5 6 7 8 9"));
    EXPECT(read_path(file_text("more.vtk", more), &d) == 0 && !strncmp(d.notice, "its array 'a' holds more values", 31),
           "%s, notice '%s'", failure_text(), d.notice);
    dataset_release(&d);

    const char *levels = IMAGE("0 2 0 1 0 1", "<CellData><DataArray type=\"UInt8\" Name=\"vtkGhostLevels\">0 "
                                              "1</DataArray></CellData>");
    EXPECT(read_path(file_text("levels.vtk", levels), &d) == 0 && d.blocks[0].blanked_cells &&
               !d.blocks[0].blanked_cells[0] && d.blocks[0].blanked_cells[1] && !d.blocks[0].field_count,
           "%s", failure_text());
    dataset_release(&d);

    const char *empty = FILE_OF(
        "ImageData", "", "<ImageData><Piece Extent=\"0 -1 0 -1 0 -1\"/><Piece Extent=\"3 4 0 1 0 1\"/></ImageData>");
    EXPECT(read_path(file_text("empty.vtk", empty), &d) == 0 && d.block_count == 1 && d.blocks[0].first[0] == 3, "%s",
           failure_text());
    dataset_release(&d);
}

/* Text that strtod reads, and the short decimals that it does not see. */
static void test_numbers(void) {
    static const char *const words[] = {"0.1",
                                        "-1e-3",
                                        "123456789012345678",
                                        "1e22",
                                        "1.7976931348623157e308",
                                        "4.9e-324",
                                        "+7.",
                                        ".5e1",
                                        "1e23",
                                        "0.30000000000000004",
                                        "-0",
                                        "inf",
                                        "-1E+05",
                                        "1e400",
                                        "9007199254740993",
                                        "5e-22"};
    static const char columns[] = "-1.0E+00-2.0D+01 0.5-101-4.25E+004.0E+00-1-2+3";
    static const double of_columns[] = {-1, -20, 0.5e-101, -4.25, 4, -1, -2, 3};
    enum { COUNT = sizeof words / sizeof *words };
    bytes file = {0};
    bytes_text(&file, "<VTKFile type=\"ImageData\"><ImageData><Piece Extent=\"0 3 0 1 0 1\"><PointData><DataArray "
                      "type=\"Float64\">");
    for (int i = 0; i < COUNT; i++) bytes_text(&file, "%s\t\r\n", words[i]);
    bytes_text(&file, "</DataArray></PointData></Piece></ImageData></VTKFile>");
    dataset d;
    EXPECT(COUNT == 16 && read_bytes("numbers.vtk", &file, &d) == 0 && d.blocks[0].field_count == 1, "%s",
           failure_text());
    for (int i = 0; i < COUNT && d.block_count; i++) {
        double is = field_value(&d.blocks[0].fields[0], (uint64_t)i), should = strtod(words[i], NULL);
        EXPECT(memcmp(&is, &should, 8) == 0, "%s is %.17g", words[i], is);
    }
    dataset_release(&d);
    file.size = 0;
    bytes_text(&file, IMAGE(CUBE, POINTS("type=\"Float64\"", "%s")), columns);
    EXPECT(read_bytes("columns.vtk", &file, &d) == 0, "%s", failure_text());
    for (uint64_t i = 0; i < 8 && d.block_count; i++)
        EXPECT(field_value(&d.blocks[0].fields[0], i) == of_columns[i], "column %d is %.17g", (int)i,
               field_value(&d.blocks[0].fields[0], i));
    dataset_release(&d);
    bytes_free(&file);
}

int main(void) {
    folder_make("vtk-xml-hostile");
    test_kinds_refused();
    test_xml();
    test_extents();
    test_arrays();
    test_blocks();
    test_cells();
    test_faces();
    test_shared_faces();
    test_sharing();
    test_notices();
    test_numbers();
    folder_remove();
    return EXPECT_DONE();
}
