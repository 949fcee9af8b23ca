#include "file/xml_root.h"

#include <stdio.h>
#include <string.h>

enum { PROLOG = 4096 };

static int is_space(unsigned char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; }

/* Copies the text between quotation marks that the bytes begin with, if it is there and has room. */
static void take_quoted(const unsigned char *at, const unsigned char *end, char type[XML_TYPE_BYTES]) {
    while (at < end && is_space(*at)) at++;
    if (at == end || (*at != '"' && *at != '\'')) return;
    const unsigned char *close = memchr(at + 1, *at, (size_t)(end - at - 1));
    if (close && close - at - 1 < XML_TYPE_BYTES)
        snprintf(type, XML_TYPE_BYTES, "%.*s", (int)(close - at - 1), (const char *)at + 1);
}

int xml_root_type(const mapping *file, char type[XML_TYPE_BYTES]) {
    const size_t size = file->size < PROLOG ? file->size : PROLOG;
    const unsigned char *tag = size ? memmem(file->bytes, size, "<VTKFile", 8) : NULL;
    *type = '\0';
    if (!tag) return 0;
    const size_t left = size - (size_t)(tag - file->bytes);
    const unsigned char *close = memchr(tag, '>', left), *end = close ? close : tag + left;
    for (const unsigned char *at = tag + 9; at + 6 < end; at++) {
        if (!is_space(at[-1]) || memcmp(at, "type", 4) != 0) continue;
        const unsigned char *sign = at + 4;
        while (sign < end && is_space(*sign)) sign++;
        if (sign == end || *sign != '=') continue;
        take_quoted(sign + 1, end, type);
        break;
    }
    return 1;
}

int xml_type_is_index(const char *type) {
    static const char *const types[] = {"PImageData", "PRectilinearGrid", "PStructuredGrid", "PUnstructuredGrid",
                                        "vtkMultiBlockDataSet"};
    for (size_t n = 0; n < sizeof types / sizeof *types; n++)
        if (strcmp(type, types[n]) == 0) return 1;
    return 0;
}
