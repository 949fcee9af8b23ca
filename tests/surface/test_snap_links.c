/*
 * test_snap_links.c - which samples method snap may take: all patterns of signs around a sample, or many of them
 *
 * Around a sample lie those of its link, inside, outside or, where their turn is earlier, on the surface already. Every
 * such pattern, reachable or not, is given to the reference's test, for a sample in the middle of a grid, on each face,
 * on each edge and at each corner of its box, of either parity and in each turn. The sample has to be taken exactly
 * where the surface cuts its link in one simple curve (common/snapped.h): too few are found as well as too many. Values
 * are such that no other sample comes near enough to be taken, and this one always does.
 *
 * Usage: test_snap_links [MOST]: patterns of a link, at random where there are more of them.
 */
#include "expect.h"
#include "random.h"
#include "reference/reference_run.h"
#include "snapped.h"

#include <inttypes.h>
#include <string.h>

enum { SAMPLES = 27, LINK_MOST = 18 };

/* A grid around one sample. */
typedef struct star {
    tc_grid_options options;
    tc_grid grid;
    signs signs;
    int64_t p[3], middle;       /* the sample, and its number */
    float values[SAMPLES];      /* of all */
    uint8_t flags[SAMPLES];     /* as the reference has them */
    int8_t sides[SAMPLES];      /* as the definition has them */
    int count, link[LINK_MOST]; /* numbers of the samples around it */
    int choices[LINK_MOST];     /* 3: such a sample may be on the surface */
    const char *name;
} star;

/* place: 0 low, 1 middle, 2 high along each axis, to the base 3. parities: of the sample's indices. */
static void star_make(star *s, int place, unsigned parities) {
    memset(s, 0, sizeof *s);
    tc_grid_options_init(&s->options);
    s->options.type = TC_F32;
    s->options.samples = s->values;
    for (int axis = 0; axis < 3; axis++, place /= 3) {
        s->options.dims[axis] = place % 3 == 1 ? 3 : 2;
        s->p[axis] = place % 3 ? 1 : 0;
        s->options.first_index[axis] = ((int64_t)(parities >> axis & 1) + s->p[axis]) % 2;
        s->grid.dims[axis] = s->options.dims[axis];
        s->grid.first[axis] = s->options.first_index[axis];
    }
    s->grid.type = TC_F32;
    s->grid.samples = s->values;
    signs_make(&s->signs, &s->options, 0);
    s->middle = signs_index(&s->signs, s->p);
    for (int n = 0; n < s->options.dims[0] * s->options.dims[1] * s->options.dims[2]; n++) {
        int64_t q[3];
        int apart = 0;
        grid_place(&s->options, n, q);
        for (int axis = 0; axis < 3; axis++) apart += q[axis] != s->p[axis];
        /* edges run along the axes, and across faces between even samples */
        if (apart == 1 || (apart == 2 && !signs_odd(&s->signs, s->p))) {
            s->choices[s->count] = sample_turn(&s->signs, q) < sample_turn(&s->signs, s->p) ? 3 : 2;
            s->link[s->count++] = n;
        }
    }
}

static uint64_t pattern_count(const star *s) {
    uint64_t count = 1;
    for (int n = 0; n < s->count; n++) count *= (uint64_t)s->choices[n];
    return count;
}

static void sample_fill(star *s, int64_t n, bool inside, float size) {
    s->values[n] = inside ? size : -size;
    s->flags[n] = (uint8_t)(PRESENT | (inside ? INSIDE : 0));
    s->sides[n] = inside ? SIDE_IN : SIDE_OUT;
}

/* Samples that are on the surface, and those that are not of the link, were inside or outside at random. */
static void star_fill(star *s, uint64_t pattern, bool inside) {
    for (int n = 0; n < s->options.dims[0] * s->options.dims[1] * s->options.dims[2]; n++)
        sample_fill(s, n, random_below(2), 1);
    sample_fill(s, s->middle, inside, 0.01f);
    for (int n = 0; n < s->count; n++) {
        const uint64_t choice = pattern % (uint64_t)s->choices[n];
        pattern /= (uint64_t)s->choices[n];
        if (choice < 2) sample_fill(s, s->link[n], choice, 1);
        if (choice < 2) continue;
        s->flags[s->link[n]] |= SNAPPED;
        s->sides[s->link[n]] = SIDE_ON;
    }
}

/* Samples taken, as a mask. */
static uint32_t taken(const star *s) {
    uint32_t mask = 0;
    for (int n = 0; n < SAMPLES; n++) mask |= (uint32_t)(s->flags[n] / SNAPPED & 1) << n;
    return mask;
}

/* Whether the sample was taken. */
static bool pattern_try(star *s, uint64_t pattern, bool inside) {
    reference r = {.grid = &s->grid, .signs = s->flags, .complete = true, .threshold = 0.4f};
    memcpy(r.dims, s->grid.dims, sizeof r.dims);
    star_fill(s, pattern, inside);
    const uint32_t before = taken(s);
    const bool regular = sample_is_regular(&s->signs, s->sides, s->p);
    samples_snap(&r);
    const uint32_t wanted = before | (uint32_t)regular << s->middle;
    EXPECT(taken(s) == wanted, "%s, parities %lld%lld%lld, pattern %" PRIu64 " of %d samples, %s: %s", s->name,
           (long long)(s->p[0] + s->grid.first[0]) % 2, (long long)(s->p[1] + s->grid.first[1]) % 2,
           (long long)(s->p[2] + s->grid.first[2]) % 2, pattern, s->count, inside ? "inside" : "outside",
           regular ? "not taken" : "taken");
    return taken(s) >> s->middle & 1;
}

static const char *const names[] = {"in the middle", "on a face", "on an edge", "at a corner"}; /* by borders */
static struct tally {
    uint64_t patterns, taken;
    bool all;
} tally[4] = {{.all = true}, {.all = true}, {.all = true}, {.all = true}};

static void test_place(int place, unsigned parities, uint64_t most) {
    star s;
    uint64_t accepted = 0;
    int borders = 0;
    star_make(&s, place, parities);
    for (int axis = 0; axis < 3; axis++) borders += s.options.dims[axis] == 2;
    s.name = names[borders];
    if (!test_chosen(s.name)) {
        signs_free(&s.signs);
        return;
    }
    const uint64_t all = pattern_count(&s), count = all < most ? all : most;
    for (uint64_t n = 0; n < count; n++) {
        const uint64_t pattern = all <= most ? n : random_u64() % all;
        const bool inside = random_below(2);
        accepted += pattern_try(&s, pattern, inside);
        if (all <= most) accepted += pattern_try(&s, pattern, !inside);
    }
    if (borders == 3)
        EXPECT(accepted == 0, "at a corner: %" PRIu64 " taken", accepted);
    else
        EXPECT(accepted > 0 && accepted < (all <= most ? 2 : 1) * count, "%s: %" PRIu64 " of %" PRIu64 " taken", s.name,
               accepted, count);
    tally[borders].patterns += count;
    tally[borders].taken += accepted;
    tally[borders].all = tally[borders].all && all <= most;
    signs_free(&s.signs);
}

/* By hand: of an octahedron's 64 patterns of two signs those are regular that are not all the same (2), not one pair of
 * opposite corners against the rest (6). */
static void test_octahedron(void) {
    star s;
    int regular = 0;
    star_make(&s, 13, 1);
    for (unsigned pattern = 0; pattern < 64; pattern++) {
        for (int n = 0; n < s.count; n++) s.sides[s.link[n]] = pattern >> n & 1 ? SIDE_IN : SIDE_OUT;
        regular += sample_is_regular(&s.signs, s.sides, s.p);
    }
    EXPECT(s.count == 6 && regular == 56, "of an octahedron %d patterns are regular", regular);
    signs_free(&s.signs);
}

int main(int argc, char **argv) {
    const uint64_t most = argc > 1 ? strtoull(argv[1], NULL, 0) : 4000;
    random_state = 1996;
    test_octahedron();
    for (int place = 0; place < 27; place++)
        for (unsigned parities = 0; parities < 8; parities++)
            test_place(place, parities, place == 13 ? 5 * most : most);
    for (int n = 0; n < 4; n++)
        printf("%s: %s%" PRIu64 " patterns, taken %" PRIu64 " times\n", names[n], tally[n].all ? "all " : "",
               tally[n].patterns, tally[n].taken);
    return EXPECT_DONE();
}
