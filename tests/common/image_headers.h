/*
 * image_headers.h - headers of images that readers take as programs write them: what is read, and the notice given
 */
#ifndef IMAGE_HEADERS_H
#define IMAGE_HEADERS_H

#include "read_files.h"

enum { COUNT = 60 }; /* samples of 5 x 4 x 3 */

#define NRRD_U8 "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 5 4 3\nencoding: raw\n"

typedef struct header_case {
    const char *header, *notice; /* as for expect_noticed */
    double matrix[12];
} header_case;

static inline expected plain(int type, const double *matrix) {
    return (expected){.stored = type, .dims = {5, 4, 3}, .matrix = matrix};
}

/* The volume is read as expected, with a notice that has this in it; NULL: without any. */
static inline void expect_noticed(const char *what, const read_request *request, const expected *e,
                                  const char *notice) {
    read_image v;
    expect_volume(what, request, e);
    if (image_read(request, &v)) return;
    EXPECT(notice ? strstr(v.d.notice, notice) != NULL : !*v.d.notice, "%s: notice '%s'", what, v.d.notice);
    image_release(&v);
}

/* Each header with the same 60 bytes behind it. */
static inline void check_headers(const char *name, const header_case *cases, size_t count) {
    bytes samples = test_samples(TC_U8, COUNT, 0);
    for (size_t n = 0; n < count; n++) {
        read_request r = request_for(file_behind(name, cases[n].header, &samples));
        expected e = plain(TC_U8, cases[n].matrix);
        expect_noticed(cases[n].header, &r, &e, cases[n].notice);
    }
    bytes_free(&samples);
}

#endif
