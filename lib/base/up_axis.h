/* up_axis.h - the axis that a letter names. Internal to lib/. */
#ifndef UP_AXIS_H
#define UP_AXIS_H

/* 'x', 'y' or 'z', and 'X', 'Y' or 'Z' for the same ones downwards; 0 for 'z'. axis: unit */
static inline void gw_up_axis(char up, double axis[3])
{
	char of = up ? up : 'z';
	int down = of >= 'X' && of <= 'Z';
	for (int k = 0; k < 3; k++)
		axis[k] = of - (down ? 'X' : 'x') == k ? (down ? -1.0 : 1.0) : 0.0;
}

#endif
