/*
 * control.h - control characters in text from files: where they are printed, they steer the terminal
 *
 * They are the codes below 32, 127 and, in UTF-8, those from 128 to 159 (C2 80 to C2 9F).
 */
#ifndef CONTROL_H
#define CONTROL_H

#include <stddef.h>

/* Bytes of the control character that the text begins with; 0 where it begins with none. */
static inline size_t control_bytes(const char *text) {
    const unsigned char first = (unsigned char)text[0];
    if (first == 0xc2) return ((unsigned char)text[1] & 0xe0) == 0x80 ? 2 : 0;
    return first && (first < ' ' || first == 127);
}

/* Overwrites every byte of a control character with '?'. keeps_lines: line feeds and tabs stay. */
static inline void control_mask(char *text, int keeps_lines) {
    while (*text) {
        const int stays = keeps_lines && (*text == '\n' || *text == '\t');
        size_t bytes = stays ? 0 : control_bytes(text);
        if (!bytes) text++;
        for (; bytes; bytes--) *text++ = '?';
    }
}

/* Copies the next byte, or the next control character as %XX for each of its bytes, and moves *from behind it. Returns
 * the bytes written, at most 6. */
static inline size_t control_encode(const char **from, char *to) {
    static const char digits[] = "0123456789ABCDEF";
    const size_t bytes = control_bytes(*from);
    size_t written = 0;
    for (size_t n = 0; n < bytes; n++) {
        const unsigned char byte = (unsigned char)*(*from)++;
        to[written++] = '%';
        to[written++] = digits[byte >> 4];
        to[written++] = digits[byte & 15];
    }
    if (!bytes) to[written++] = *(*from)++;
    return written;
}

#endif
