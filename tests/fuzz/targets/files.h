/*
 * files.h - the files of one input of the fuzzer, which readers open by mapping_open
 *
 * An input is one or more files with a marker between them, then OPTION_BYTES bytes of options. The first file is the
 * one that is read; any other name stands for the one that its last digit tells, 1 where it has none. Every file lies
 * in memory of its exact size, so that AddressSanitizer sees the first byte read behind its end: files.c takes the
 * place of mapping.c and, through the linker's --wrap, of munmap(), access() and realpath().
 */
#ifndef FILES_H
#define FILES_H

#include <stddef.h>
#include <stdint.h>

#define FILES_FOLDER "in/"

enum { OPTION_BYTES = 4, FILES_MOST = 10 };

/* Takes the input apart. path, within FILES_FOLDER, is the first file's; options receives OPTION_BYTES, zeros where the
 * input is shorter. */
void files_open(const char *path, const uint8_t *input, size_t size, uint8_t options[OPTION_BYTES]);

/* To be called when everything was released: traps where something is still mapped. */
void files_close(void);

#endif
