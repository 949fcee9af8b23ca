/*
 * test_complex_check.c - the check of faces: small complexes, planted faults, and every pair of faces compared by brute
 * force on random ones
 */
#include "complex_check.h"
#include "expect.h"
#include "random.h"

#include <stdlib.h>
#include <string.h>

enum { POINTS_MOST = 9000, TETRAHEDRA_MOST = 200 };

static void expect_faces(const char *name, const complex_faces *is, const complex_faces *should) {
    EXPECT(is->folded_faces == should->folded_faces && is->nonmanifold_faces == should->nonmanifold_faces &&
               is->invalid_tetrahedra == should->invalid_tetrahedra,
           "%s: folded %llu/%llu, non-manifold %llu/%llu, invalid %llu/%llu (is/should)", name,
           (unsigned long long)is->folded_faces, (unsigned long long)should->folded_faces,
           (unsigned long long)is->nonmanifold_faces, (unsigned long long)should->nonmanifold_faces,
           (unsigned long long)is->invalid_tetrahedra, (unsigned long long)should->invalid_tetrahedra);
}

static const struct {
    const char *name;
    uint64_t point_count, count;
    uint32_t tetrahedra[3][4];
    const char *sides; /* a digit per point */
    complex_faces should;
} known[] = {
    {"nothing", 0, 0, {{0}}, NULL, {0, 0, 0}},
    {"one", 4, 1, {{0, 1, 2, 3}}, NULL, {0, 0, 0}},
    {"two that fit", 5, 2, {{0, 1, 2, 3}, {0, 2, 1, 4}}, NULL, {0, 0, 0}},
    {"two on one side", 5, 2, {{0, 1, 2, 3}, {0, 1, 2, 4}}, NULL, {1, 0, 0}},
    {"two on one side, turned", 5, 2, {{0, 1, 2, 3}, {4, 1, 0, 2}}, NULL, {1, 0, 0}},
    {"one twice", 4, 2, {{0, 1, 2, 3}, {1, 2, 0, 3}}, NULL, {4, 0, 0}},
    {"one and its mirror image", 4, 2, {{0, 1, 2, 3}, {1, 0, 2, 3}}, NULL, {0, 0, 0}},
    {"three at a face", 6, 3, {{0, 1, 2, 3}, {0, 2, 1, 4}, {0, 1, 2, 5}}, NULL, {0, 1, 0}},
    {"a point twice", 5, 2, {{0, 1, 2, 3}, {0, 1, 2, 2}}, NULL, {0, 0, 1}},
    {"a point that is not there", 4, 2, {{0, 1, 2, 3}, {0, 1, 2, 4}}, NULL, {0, 0, 1}},
    {"a last number", 4, 2, {{0, 1, 2, 3}, {0, 1, 2, UINT32_MAX}}, "0111", {0, 0, 1}},
    {"crossed", 5, 2, {{0, 1, 2, 3}, {0, 1, 2, 4}}, "01000", {1, 0, 0}},
    {"not crossed", 5, 2, {{0, 1, 2, 3}, {0, 1, 2, 4}}, "11100", {0, 0, 0}},
    {"one missing", 5, 2, {{0, 1, 2, 3}, {0, 1, 2, 4}}, "01002", {0, 0, 0}},
    {"one of three missing", 6, 3, {{0, 1, 2, 3}, {0, 2, 1, 4}, {0, 1, 2, 5}}, "110020", {1, 0, 0}},
};

static void known_complexes(void) {
    for (size_t n = 0; n < sizeof known / sizeof *known; n++) {
        complex_faces faces;
        uint8_t sides[8];
        for (size_t p = 0; known[n].sides && known[n].sides[p]; p++) sides[p] = (uint8_t)(known[n].sides[p] - '0');
        int status = complex_check(known[n].point_count, known[n].tetrahedra[0], known[n].count,
                                   known[n].sides ? sides : NULL, &faces);
        EXPECT(status == 0, "%s: status %d", known[n].name, status);
        expect_faces(known[n].name, &faces, &known[n].should);
    }
}

/* ---------------------------------------------------------------------------------------------------- brute force */

/* Whether two tetrahedra share exactly the face without corners n and m: 1 where they pass it in opposite directions,
 * -1 where in the same one, 0 where they do not share it. The direction is the parity of the permutation between the
 * two when the fourth corners, too, are taken for the same point. */
static int faces_meet(const uint32_t a[4], int n, const uint32_t b[4], int m) {
    int place[4], sign = -1;
    for (int k = 0; k < 4; k++) {
        place[k] = k == n ? m : -1;
        for (int l = 0; l < 4; l++)
            if (k != n && l != m && a[k] == b[l]) place[k] = l;
        if (place[k] < 0) return 0;
    }
    for (int k = 0; k < 4; k++)
        for (int l = 0; l < k; l++)
            if (place[l] > place[k]) sign = -sign;
    return sign;
}

static int counts(const uint32_t v[4], int corner, const uint8_t *sides) {
    int seen[2] = {0};
    for (int k = 0; k < 4 && sides; k++) {
        if (sides[v[k]] == SIDE_MISSING) return 0;
        if (k != corner) seen[sides[v[k]]] = 1;
    }
    return !sides || (seen[0] && seen[1]);
}

static complex_faces brute_force(const uint32_t (*t)[4], int count, const uint8_t *sides) {
    complex_faces faces = {0};
    for (int a = 0; a < 4 * count; a++) {
        int others = 0, lower = 0, same = 0;
        if (!counts(t[a / 4], a % 4, sides)) continue;
        for (int b = 0; b < 4 * count; b++) {
            int meet = b == a || !counts(t[b / 4], b % 4, sides) ? 0 : faces_meet(t[a / 4], a % 4, t[b / 4], b % 4);
            others += meet != 0;
            same += meet < 0;
            lower += meet && b < a;
        }
        if (lower) continue;
        faces.folded_faces += others == 1 && same == 1;
        faces.nonmanifold_faces += others > 1;
    }
    return faces;
}

/* Points from a few of many, so that faces are shared and points lie in several threads' shares. */
static void random_complex(int round) {
    static uint32_t t[TETRAHEDRA_MOST][4];
    static uint8_t sides[POINTS_MOST];
    uint32_t spread = 1 + random_below(POINTS_MOST / 16), few = 5 + random_below(12);
    int count = 1 + (int)random_below(TETRAHEDRA_MOST);
    for (int n = 0; n < count; n++)
        for (int k = 0; k < 4; k++) {
            int is_new;
            do {
                t[n][k] = spread * random_below(few < 16 ? few : 16);
                is_new = 1;
                for (int l = 0; l < k; l++) is_new = is_new && t[n][l] != t[n][k];
            } while (!is_new);
        }
    for (int p = 0; p < POINTS_MOST; p++) sides[p] = (uint8_t)(random_below(12) ? random_below(2) : SIDE_MISSING);
    for (int with_sides = 0; with_sides < 2; with_sides++) {
        const uint8_t *given = with_sides ? sides : NULL;
        complex_faces faces, should = brute_force((const uint32_t(*)[4])t, count, given);
        char name[64];
        snprintf(name, sizeof name, "random complex %d%s", round, given ? " with sides" : "");
        EXPECT(complex_check(POINTS_MOST, t[0], (uint64_t)count, given, &faces) == 0, "%s: failed", name);
        expect_faces(name, &faces, &should);
    }
}

/* A fan around one edge: many faces at one point. One tetrahedron turned over folds its two faces within the fan. */
static void fan(void) {
    enum { COUNT = 1000 };
    static uint32_t t[COUNT][4];
    for (uint32_t n = 0; n < COUNT; n++) {
        const uint32_t one[4] = {0, 1, 2 + n, 2 + (n + 1) % COUNT};
        memcpy(t[n], one, sizeof one);
    }
    for (uint64_t turned = 0; turned < 2; turned++) {
        complex_faces faces, should = {.folded_faces = 2 * turned};
        if (turned) t[500][0] = 1, t[500][1] = 0;
        EXPECT(complex_check(COUNT + 2, t[0], COUNT, NULL, &faces) == 0, "fan: failed");
        expect_faces("fan", &faces, &should);
    }
}

int main(void) {
    known_complexes();
    fan();
    for (int round = 0; round < 300; round++) random_complex(round);
    return EXPECT_DONE();
}
