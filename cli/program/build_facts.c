#include "program/build_facts.h"

const char *build_facts_compiler(void)
{
#ifdef __clang__
	return "clang " __clang_version__;
#else
	return "gcc " __VERSION__;
#endif
}

const char *build_facts_flags(void)
{
	return
#include "build_flags.inc" /* the build writes it */
		;
}
