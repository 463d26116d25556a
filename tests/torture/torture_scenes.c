#include "torture_child.h"
static long count(bool s)
{
	(void)s;
	return 0;
}
static void run(torture_case *c)
{
	(void)c;
}
const torture_part scenes_part = { "scenes", "", count, run };
