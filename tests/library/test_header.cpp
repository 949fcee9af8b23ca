// test_header.cpp - the public header serves C++ programs: it compiles after the standard headers that C++ shares with
// C, and its functions have C names
#include <cassert>
#include <cctype>
#include <cerrno>
#include <cfenv>
#include <cfloat>
#include <cinttypes>
#include <climits>
#include <clocale>
#include <cmath>
#include <complex.h> // as C++ has it: <complex>, and in some libraries the macros of C
#include <csetjmp>
#include <csignal>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <cwchar>
#include <cwctype>
#include <tgmath.h>

#include "tetracubes.h"

int main() {
    const unsigned char samples[8] = {255, 0, 0, 0, 0, 0, 0, 0};
    tc_context_options device;
    tc_grid_options volume;
    tc_extract_options how;
    tc_context *context = nullptr;
    tc_grid *grid = nullptr;
    tc_mesh *mesh = nullptr;
    tc_mesh_data data{};
    data.struct_size = sizeof data;
    tc_context_options_init(&device);
    tc_grid_options_init(&volume);
    tc_extract_options_init(&how);
    device.engine = TC_ENGINE_REFERENCE;
    volume.dims[0] = volume.dims[1] = volume.dims[2] = 2;
    volume.samples = samples;
    how.isovalue = 127.5;
    tc_status status = tc_context_create(&device, &context);
    if (status == TC_OK) status = tc_grid_create(context, &volume, &grid);
    if (status == TC_OK) status = tc_extract(grid, &how, &mesh);
    if (status == TC_OK) status = tc_mesh_get(mesh, &data);
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    tc_context_destroy(context);
    // one corner inside: six edges leave it, four of the five tetrahedra have it
    bool right = status == TC_OK && data.vertex_count == 6 && data.triangle_count == 4;
    std::printf("%s: %s\n", tc_version(), right ? "a corner was cut off" : tc_message());
    return right ? 0 : 1;
}
