/*
 * The mode that computes wrongly and reports success: what a broken driver does.
 *
 * Either what kernels have made is changed behind them, bit by bit, or launches are left out, or programs are built
 * from other text than they were given: the errors of a compiler. Programs from binaries are as they were; so tests
 * switch the cache of programs off.
 */
#include "layer.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static cl_icd_dispatch below;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

/* What is on; kernel: of drop and flip. */
static enum { NOTHING, DROP, FLIP, READ, BUILD } action;
static char kernel_name[64];
static unsigned long first_launch, launches;
static unsigned argument_index;
static size_t byte_index;
static unsigned bit_index;

/* ----------------------------------------------------------------------------------------------------- compilers */

/* A mistake: text that stands in the kernels, and what is compiled in its place. "starved" is no mistake of a compiler:
 * a group waits for one that the device does not run, and sees the tile before without sums; for a single group. */
typedef struct mistake {
    const char *name, *from, *to;
} mistake;

static const mistake mistakes[] = {
    {"popcount", "return (x * 0x0101010101010101ul) >> 56;",
     "x = (x * 0x0101010101010101ul) >> 56; return x + lanes_select(x == 33ul);"},
    {"division", "return a / b; }", "float q = a / b; return as_float(as_uint(q) + ((as_uint(q) & 15) == 1)); }"},
    {"subnormals", "float crossing(REAL a, REAL b, REAL iso) {\n",
     "float crossing(REAL a, REAL b, REAL iso) {\n a = fabs(a) < 0x1p-126f ? 0 : a; b = fabs(b) < 0x1p-126f ? 0 : "
     "b;\n"},
    {"overflow", "isinf(b - a) ? (REAL)0.5f : (REAL)1", "(REAL)1"},
    {"contraction", "((m[0] * x + m[1] * y) + m[2] * z) + m[3]", "fma(m[2], z, fma(m[0], x, m[1] * y)) + m[3]"},
    {"look-back", "*sum += word & SCAN_VALUE;", "*sum += word & 0xfff;"},
    {"fallback", "atomic_add(&shared[PREFIX_VERTICES], e.vertices);",
     "atomic_add(&shared[PREFIX_VERTICES], e.vertices + 1);"},
    {"starved", "uint2 prefix = tile_prefix(",
     "for (uint c = 0; tile_index && c < 2; c++) atomic_xchg(scan_at(tiles, tile_index - 1, c), scan_word(SCAN_EMPTY, "
     "0));\n"
     "uint2 prefix = tile_prefix("},
    {"comparison", "<= (samples64)(BITS)test->inside_span", "< (samples64)(BITS)test->inside_span"},
};
enum { MISTAKES = sizeof mistakes / sizeof *mistakes };
static const mistake *made;
static unsigned long mistaken; /* places */

/* From malloc: text with every `from` made `to`. */
static char *text_change(const char *text, const mistake *m) {
    size_t count = 0, from = strlen(m->from), to = strlen(m->to);
    for (const char *at = text; (at = strstr(at, m->from)); at += from) count++;
    char *out = malloc(strlen(text) + count * to + 1), *put = out;
    for (const char *at; out && (at = strstr(text, m->from)); text = at + from) {
        memcpy(put, text, (size_t)(at - text));
        put += at - text;
        memcpy(put, m->to, to);
        put += to;
    }
    if (out) memcpy(put, text, strlen(text) + 1);
    mistaken += count;
    return out;
}

static cl_program CL_API_CALL CreateProgramWithSource(cl_context context, cl_uint count, const char **texts,
                                                      const size_t *lengths, cl_int *error) {
    enum { TEXTS_MOST = 32 };
    char *changed[TEXTS_MOST];
    if (action != BUILD || lengths || count > TEXTS_MOST)
        return below.clCreateProgramWithSource(context, count, texts, lengths, error);
    pthread_mutex_lock(&lock);
    for (cl_uint n = 0; n < count; n++) changed[n] = text_change(texts[n], made);
    pthread_mutex_unlock(&lock);
    cl_program program = below.clCreateProgramWithSource(context, count, (const char **)changed, NULL, error);
    for (cl_uint n = 0; n < count; n++) free(changed[n]);
    return program;
}

/* ------------------------------------------------------------------------------------------------------- results */

enum { KERNELS_MOST = 64, ARGUMENTS_MOST = 24 };

/* The buffers last given to a kernel. */
static struct {
    cl_kernel kernel;
    cl_mem memory[ARGUMENTS_MOST];
} given[KERNELS_MOST];

static cl_int CL_API_CALL SetKernelArg(cl_kernel kernel, cl_uint index, size_t bytes, const void *value) {
    const cl_int error = below.clSetKernelArg(kernel, index, bytes, value);
    if (error || bytes != sizeof(cl_mem) || !value || index >= ARGUMENTS_MOST) return error;
    pthread_mutex_lock(&lock);
    int n = 0;
    while (n < KERNELS_MOST - 1 && given[n].kernel && given[n].kernel != kernel) n++;
    given[n].kernel = kernel;
    memcpy(&given[n].memory[index], value, sizeof(cl_mem));
    pthread_mutex_unlock(&lock);
    return error;
}

static bool is_meant(cl_kernel kernel) {
    char name[sizeof kernel_name] = "";
    below.clGetKernelInfo(kernel, CL_KERNEL_FUNCTION_NAME, sizeof name, name, NULL);
    return !strcmp(name, kernel_name) && ++launches >= first_launch;
}

static cl_mem argument_of(cl_kernel kernel) {
    for (int n = 0; n < KERNELS_MOST; n++)
        if (given[n].kernel == kernel) return given[n].memory[argument_index];
    return NULL;
}

/* Waits for the queue, so the kernel is over. */
static void bit_flip(cl_command_queue queue, cl_mem memory) {
    unsigned char byte;
    if (below.clEnqueueReadBuffer(queue, memory, CL_TRUE, byte_index, 1, &byte, 0, NULL, NULL)) return;
    byte ^= (unsigned char)(1u << bit_index);
    below.clEnqueueWriteBuffer(queue, memory, CL_TRUE, byte_index, 1, &byte, 0, NULL, NULL);
}

static cl_int CL_API_CALL EnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions,
                                               const size_t *first, const size_t *global, const size_t *local,
                                               ENTRY_WAITS) {
    pthread_mutex_lock(&lock);
    const bool meant = (action == DROP || action == FLIP) && is_meant(kernel);
    cl_mem memory = meant && action == FLIP ? argument_of(kernel) : NULL;
    pthread_mutex_unlock(&lock);
    if (meant && action == DROP) return below.clEnqueueMarkerWithWaitList(queue, wait_count, waits, event);
    const cl_int error =
        below.clEnqueueNDRangeKernel(queue, kernel, dimensions, first, global, local, wait_count, waits, event);
    if (!error && memory) bit_flip(queue, memory);
    return error;
}

static cl_int CL_API_CALL EnqueueReadBuffer(cl_command_queue queue, cl_mem memory, cl_bool blocking, size_t offset,
                                            size_t bytes, void *to, ENTRY_WAITS) {
    const bool flips = action == READ && byte_index < bytes;
    const cl_int error =
        below.clEnqueueReadBuffer(queue, memory, blocking || flips, offset, bytes, to, wait_count, waits, event);
    if (!error && flips) ((unsigned char *)to)[byte_index] ^= (unsigned char)(1u << bit_index);
    return error;
}

/* -------------------------------------------------------------------------------------------------------- commands */

static void install(cl_icd_dispatch *table) {
    below = *table;
    table->clCreateProgramWithSource = CreateProgramWithSource;
    table->clSetKernelArg = SetKernelArg;
    table->clEnqueueNDRangeKernel = EnqueueNDRangeKernel;
    table->clEnqueueReadBuffer = EnqueueReadBuffer;
}

static bool mistake_choose(const char *name) {
    for (made = mistakes; made < mistakes + MISTAKES; made++)
        if (!strcmp(made->name, name)) return true;
    return false;
}

static bool bit_choose(const char *byte, const char *bit) {
    byte_index = strtoul(byte, NULL, 10);
    bit_index = (unsigned)strtoul(bit, NULL, 10);
    return bit_index < 8;
}

/* A compiler's mistake that no text had room for would prove nothing. */
static void mistakes_tell(void) {
    if (action == BUILD && !mistaken) fault("no program has the text of the mistake '%s'", made->name);
}

static bool command(char *const *words, int count) {
    const char *what = count > 1 ? words[1] : "";
    mistakes_tell();
    action = NOTHING;
    launches = 0;
    if (count > 2) snprintf(kernel_name, sizeof kernel_name, "%s", words[2]);
    if (!strcmp(what, "drop") && count >= 3) {
        first_launch = count > 3 ? strtoul(words[3], NULL, 10) : 1;
        action = DROP;
    } else if (!strcmp(what, "flip") && count == 6 && bit_choose(words[4], words[5])) {
        argument_index = (unsigned)strtoul(words[3], NULL, 10) % ARGUMENTS_MOST;
        first_launch = 1;
        action = FLIP;
    } else if (!strcmp(what, "read") && count == 4 && bit_choose(words[2], words[3])) {
        action = READ;
    } else if (!strcmp(what, "build") && count == 3 && mistake_choose(words[2])) {
        action = BUILD;
        mistaken = 0;
        atexit(mistakes_tell);
    }
    return action != NOTHING || !strcmp(what, "off");
}

const layer_mode corrupt_mode = {"corrupt", install, command};
