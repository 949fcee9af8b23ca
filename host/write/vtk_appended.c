/* vtk_appended.c - VTK XML files whose arrays follow each other as raw appended data; see vtk_appended.h */
#include "vtk_appended.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LENGTH_BYTES = 8 };

static uint64_t array_bytes(const vtk_array *a) { return a->span.count * a->record_bytes; }

/* Bytes of the UTF-8 character at s, 0 where there is none, or one that XML does not take. */
static size_t character_bytes(const unsigned char *s) {
    uint32_t code = s[0];
    size_t bytes = code < 0x80 ? 1 : code >= 0xc2 && code < 0xe0 ? 2 : code >= 0xe0 && code < 0xf0 ? 3 : 4;
    if (bytes == 1) return code >= 0x20 && code != 0x7f;
    if (bytes == 4 && (code < 0xf0 || code > 0xf4)) return 0;
    code &= 0x7fu >> bytes;
    for (size_t i = 1; i < bytes; i++) {
        if ((s[i] & 0xc0) != 0x80) return 0;
        code = code << 6 | (s[i] & 0x3f);
    }
    int is_long = code < (bytes == 2 ? 0x80u : bytes == 3 ? 0x800u : 0x10000u);
    int is_refused = (code >= 0xd800 && code < 0xe000) || code == 0xfffe || code == 0xffff || code > 0x10ffff;
    return is_long || is_refused ? 0 : bytes;
}

static void add_escaped(file_text *t, const char *name) {
    for (const unsigned char *s = (const unsigned char *)name; *s;) {
        size_t bytes = character_bytes(s);
        const char *entity = *s == '&'   ? "&amp;"
                             : *s == '<' ? "&lt;"
                             : *s == '>' ? "&gt;"
                             : *s == '"' ? "&quot;"
                                         : NULL;
        if (entity)
            text_add(t, "%s", entity);
        else
            text_add(t, "%.*s", bytes ? (int)bytes : 1, bytes ? (const char *)s : "_");
        s += bytes ? bytes : 1;
    }
}

/* The name as it stands in the text. */
static void add_array(vtk_file *f, const vtk_array *array, const char *name) {
    vtk_array *arrays = realloc(f->arrays, (f->array_count + 1) * sizeof *arrays);
    if (!arrays) {
        f->text.has_failed = 1;
        return;
    }
    f->arrays = arrays;
    arrays[f->array_count++] = *array;
    text_add(&f->text,
             "        <DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"appended\" "
             "offset=\"%llu\"/>\n",
             stored_types[array->type].vtk_xml, name, array->components, (unsigned long long)f->appended_bytes);
    f->appended_bytes += LENGTH_BYTES + array_bytes(array); /* and no padding: meshio expects the next array there */
}

/* A string is the codes of its characters, and 0. */
static void add_note(vtk_file *f, const char *name, const char *value) {
    text_add(&f->text, "      <Array type=\"String\" Name=\"%s\" NumberOfTuples=\"1\" format=\"ascii\">", name);
    for (const char *at = value; *at; at++) text_add(&f->text, "%d ", *at);
    text_add(&f->text, "0</Array>\n");
}

void vtk_notes_add(vtk_file *f, const char *world, const char *units) {
    const int has_world = world && *world, has_units = units && *units;
    if (!has_world && !has_units) return;
    text_add(&f->text, "    <FieldData>\n");
    if (has_world) add_note(f, "SPACE", world);
    if (has_units) add_note(f, "UNITS", units);
    text_add(&f->text, "    </FieldData>\n");
}

void vtk_array_add(vtk_file *f, const vtk_array *array) { add_array(f, array, array->name); }

static int is_taken(const vtk_file *f, const char *name, const char *const *own) {
    for (; *own; own++)
        if (strcmp(name, *own) == 0) return 1;
    for (size_t n = 0; n < f->field_count; n++)
        if (strcmp(name, f->field_names[n]) == 0) return 1;
    return 0;
}

void vtk_field_add(vtk_file *f, const vtk_array *array, const char *const *own) {
    file_text name = {0};
    char **names = realloc(f->field_names, (f->field_count + 1) * sizeof *names);
    if (names) f->field_names = names;
    text_add(&name, "%s", "");
    add_escaped(&name, array->name);
    while (names && !name.has_failed && is_taken(f, name.bytes, own)) text_add(&name, "_");
    if (!names || name.has_failed) {
        f->text.has_failed = 1;
        text_release(&name);
        return;
    }
    names[f->field_count++] = name.bytes;
    add_array(f, array, name.bytes);
}

static void write_array(output *o, const vtk_array *a) {
    uint64_t bytes = array_bytes(a);
    output_bytes(o, &bytes, sizeof bytes);
    output_span(o, a->span, a->record_bytes, a->encode, a->source);
}

void vtk_file_write(vtk_file *f, const char *grid) {
    static const char end[] = "\n  </AppendedData>\n</VTKFile>\n";
    file_text head = {.has_failed = f->text.has_failed};
    text_add(&head,
             "<?xml version=\"1.0\"?>\n<VTKFile type=\"%s\" version=\"1.0\" byte_order=\"LittleEndian\" "
             "header_type=\"UInt64\">\n  <%s>\n%s  </%s>\n  <AppendedData encoding=\"raw\">\n_",
             grid, grid, f->text.bytes ? f->text.bytes : "", grid);
    if (head.has_failed) {
        if (!f->o->error) f->o->error = ENOMEM;
    } else {
        output_expect(f->o, head.length + f->appended_bytes + sizeof end - 1);
        output_bytes(f->o, head.bytes, head.length);
        for (size_t i = 0; i < f->array_count; i++) write_array(f->o, &f->arrays[i]);
        output_bytes(f->o, end, sizeof end - 1);
    }
    text_release(&head);
    text_release(&f->text);
    for (size_t i = 0; i < f->field_count; i++) free(f->field_names[i]);
    free(f->field_names);
    free(f->arrays);
    *f = (vtk_file){.o = f->o};
}
