/* kernel_sources.h - the text of the programs of kernels, embedded at build time (embed.cmake) */
#ifndef KERNEL_SOURCES_H
#define KERNEL_SOURCES_H

extern const char kernel_classify_alone[], kernel_classify_groups[];
extern const char kernel_emit_alone[], kernel_emit_groups[], kernel_snap_alone[], kernel_snap_groups[];
extern const char kernel_complex_alone[], kernel_complex_groups[];
extern const char kernel_complex_caps_alone[], kernel_complex_caps_groups[];
extern const char kernel_complex_interval_alone[], kernel_complex_interval_groups[];
extern const char kernel_labels_alone[], kernel_labels_groups[];
extern const char kernel_interval_groups[];

#endif
