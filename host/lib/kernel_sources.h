/* kernel_sources.h - the kernels' text, embedded at build time (embed.cmake) */
#ifndef KERNEL_SOURCES_H
#define KERNEL_SOURCES_H

extern const char *const kernel_sources[];
extern const unsigned kernel_source_count;

#endif
