/*
 * test_spare_blocks.c - memory of results that were destroyed: which blocks are kept, which are taken, and when all go
 */
#include "base/spare_blocks.h"

#include "expect.h"

#include <pthread.h>
#include <string.h>
#include <sys/resource.h>

static const uint64_t unit = HUGE_PAGE_BYTES;

/* A spare block of so many units; returns its address. */
static void *given(spare_blocks *spare, uint64_t units) {
    host_block block = {0};
    EXPECT(!host_block_reserve(&block, units * unit), "%d units", (int)units);
    void *memory = block.memory;
    spare_block_give(spare, &block);
    EXPECT(!block.memory, "a block that was given is not the giver's");
    return memory;
}

static void *taken(spare_blocks *spare, host_block *block, uint64_t units) {
    EXPECT(!spare_block_take(spare, block, units * unit) && block->bytes >= units * unit, "%d units", (int)units);
    memset(block->memory, 1, units * unit);
    return block->memory;
}

static void test_which(void) {
    spare_blocks *spare = spare_blocks_create();
    void *of[6];
    host_block a = {0}, b = {0};
    for (uint64_t n = 1; n <= 5; n++) of[n] = given(spare, n); /* four are kept, so the smallest is not */
    EXPECT(spare_blocks_bytes(spare) == 14 * unit, "the largest four are kept");
    EXPECT(taken(spare, &a, 3) == of[3], "the smallest that is large enough is taken");
    EXPECT(taken(spare, &a, 2) == of[3] && spare_blocks_bytes(spare) == 11 * unit, "a block that suffices stays");
    EXPECT(taken(spare, &b, 1) == of[2], "a smaller one is taken for less");
    taken(spare, &b, 6);
    EXPECT(spare_blocks_bytes(spare) == 4 * unit, "where none is large enough, the largest is released");
    given(spare, 1);
    EXPECT(spare_blocks_bytes(spare) == 5 * unit, "there is room for small ones");
    spare_block_give(spare, &a), spare_block_give(spare, &b);
    EXPECT(spare_blocks_bytes(spare) == 14 * unit, "all four");
    spare_blocks_close(spare);
}

static void test_closed(void) {
    spare_blocks *spare = spare_blocks_create(), *result = spare_blocks_join(spare);
    host_block block = {0};
    given(spare, 1);
    spare_blocks_close(spare);
    EXPECT(spare_blocks_bytes(result) == 0, "closing releases all");
    given(result, 1);
    EXPECT(spare_blocks_bytes(result) == 0, "nothing is kept after that");
    taken(result, &block, 1);
    spare_block_give(result, &block);
    spare_blocks_leave(result);
    EXPECT(!spare_blocks_join(NULL) && spare_blocks_bytes(NULL) == 0, "none at all");
    taken(NULL, &block, 1);
    spare_block_give(NULL, &block);
    EXPECT(!block.memory, "without spare ones a block is released");
}

/* Address space for three blocks and a half: that of the spare ones has to go. */
static void test_limit(void) {
    spare_blocks *spare = spare_blocks_create();
    host_block block = {0};
    struct rlimit before, limit;
    const uint64_t large = 256;
    for (int n = 0; n < 3; n++) given(spare, large - (uint64_t)n); /* the largest goes in any case */
    unsigned long long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    EXPECT(file && fscanf(file, "%llu", &pages) == 1, "the size of this process");
    if (file) fclose(file);
    EXPECT(!getrlimit(RLIMIT_AS, &before), "limits");
    limit = before;
    limit.rlim_cur = pages * PAGE_BYTES + large * unit / 2;
    EXPECT(!setrlimit(RLIMIT_AS, &limit), "a limit");
    EXPECT(!spare_block_take(spare, &block, 2 * large * unit), "spare blocks make room");
    EXPECT(spare_blocks_bytes(spare) == 0, "they are released for that");
    spare_block_give(spare, &block);
    EXPECT(spare_block_take(spare, &block, 8 * large * unit) == TC_ERROR_MEMORY && !block.memory, "more there is not");
    setrlimit(RLIMIT_AS, &before);
    spare_blocks_close(spare);
}

static void *use(void *spare) {
    spare_blocks_join(spare);
    for (uint64_t n = 0; n < 2000; n++) {
        host_block block = {0};
        unsigned char *memory = spare_block_take(spare, &block, (n % 7 + 1) * PAGE_BYTES) ? NULL : block.memory;
        EXPECT(memory, "a block");
        if (memory) memory[n % 7 * PAGE_BYTES] = (unsigned char)n;
        EXPECT(!memory || memory[n % 7 * PAGE_BYTES] == (unsigned char)n, "no other thread has it");
        spare_block_give(spare, &block);
    }
    spare_blocks_leave(spare);
    return NULL;
}

static void test_threads(void) {
    spare_blocks *spare = spare_blocks_create();
    pthread_t threads[4];
    for (int n = 0; n < 4; n++) EXPECT(!pthread_create(&threads[n], NULL, use, spare), "a thread");
    for (int n = 0; n < 4; n++) pthread_join(threads[n], NULL);
    spare_blocks_close(spare);
}

int main(void) {
    test_which();
    test_closed();
    test_limit();
    test_threads();
    return EXPECT_DONE();
}
