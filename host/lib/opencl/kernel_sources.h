/* kernel_sources.h - the kernels' text, embedded at build time (embed.cmake) */
#ifndef KERNEL_SOURCES_H
#define KERNEL_SOURCES_H

extern const char kernel_source_slab[];
extern const char kernel_source_common[];
extern const char kernel_source_extensions[];
extern const char kernel_source_lanes_alone[];
extern const char kernel_source_lanes_groups[];
extern const char kernel_source_words[];
extern const char kernel_source_words_alone[];
extern const char kernel_source_words_groups[];
extern const char kernel_source_tetrahedra[];
extern const char kernel_source_cells[];
extern const char kernel_source_ranges[];
extern const char kernel_source_ranges_alone[];
extern const char kernel_source_sign[];
extern const char kernel_source_sign_alone[];
extern const char kernel_source_sign_groups[];
extern const char kernel_source_count[];
extern const char kernel_source_count_alone[];
extern const char kernel_source_count_groups[];
extern const char kernel_source_scan[];
extern const char kernel_source_classify[];
extern const char kernel_source_crossing[];
extern const char kernel_source_vertex[];
extern const char kernel_source_mesh[];
extern const char kernel_source_emit_numbers[];
extern const char kernel_source_emit_brick[];
extern const char kernel_source_emit_rows[];
extern const char kernel_source_emit[];
extern const char kernel_source_complex_job[];
extern const char kernel_source_complex_cluster[];
extern const char kernel_source_complex_cluster_alone[];
extern const char kernel_source_complex_cluster_groups[];
extern const char kernel_source_complex_tile[];
extern const char kernel_source_complex_count[];
extern const char kernel_source_complex_count_alone[];
extern const char kernel_source_complex_count_groups[];
extern const char kernel_source_complex_classify[];
extern const char kernel_source_complex_join[];
extern const char kernel_source_complex_join_alone[];
extern const char kernel_source_complex_join_groups[];
extern const char kernel_source_complex_number[];
extern const char kernel_source_complex_emit[];

#endif
