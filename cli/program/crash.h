/*
 * crash.h - when a library dies within the program: a Vulkan driver or a compiler in it does so
 * where it gets no memory or no thread.
 *
 * No library can be made to go on, but temporary files are removed, a sentence says what happened,
 * and the process ends with EXIT_CODE_MEMORY. A fault of the program itself ends it as ever, but
 * for the temporary files.
 */
#ifndef CRASH_H
#define CRASH_H

/* Installs the handlers; at the start of main. */
void crash_install(void);

/* From now on the process may end. */
void crash_finish(void);

#endif
