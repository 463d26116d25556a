/*
 * signals.h - being asked to stop.
 *
 * The first SIGINT, SIGTERM or SIGHUP asks; the work stops at its next step and cleans up. The
 * second one, or half a second in which no step came, removes temporary files and ends the process
 * at once. SIGPIPE and SIGXFSZ are ignored, so that a closed pipe is a failed write like a full
 * disk.
 */
#ifndef SIGNALS_H
#define SIGNALS_H

#include "glowworm.h"

/* Installs the handlers, and opens /dev/null where one of the three standard streams is closed. */
void signals_install(void);

/* Who asks to stop gives no time for it, as mpirun: files go at the first signal. */
void signals_expect_haste(void);

/* The signal that asked to stop, or 0. */
int signals_pending(void);

/* GW_ERROR_CANCELLED when one did. */
gw_status signals_check(gw_error *error);

#endif
