/*
 * build_facts.h - how this program was built, for those who have to find out what went wrong.
 */
#ifndef BUILD_FACTS_H
#define BUILD_FACTS_H

/* Name and version of the compiler. */
const char *build_facts_compiler(void);

/* What it was told, without folders and warnings. */
const char *build_facts_flags(void);

#endif
