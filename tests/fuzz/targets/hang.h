/*
 * hang.h - the processor time that one input may take
 *
 * libFuzzer's -timeout goes by the clock on the wall, and so finds hangs wherever a machine is busy with other work.
 */
#ifndef HANG_H
#define HANG_H

/* To be called for every input: traps where it takes more than ten seconds of processor time. */
void hang_watch(void);

#endif
