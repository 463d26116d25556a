/*
 * clock.h - elapsed time.
 */
#ifndef CLOCK_H
#define CLOCK_H

/* Seconds of a clock that never steps back; only differences mean something. Thread-safe. */
double gw_seconds(void);

#endif
