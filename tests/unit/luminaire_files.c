#include "luminaire_files.h"

#include <math.h>
#include <stdio.h>

#define DEGREE (M_PI / 180.0)

static size_t count_of(const double range[3])
{
	return range[2] > 0.0 ? (size_t)lround((range[1] - range[0]) / range[2]) + 1 : 1;
}

static double angle_of(const double range[3], size_t i)
{
	return range[0] + (double)i * range[2];
}

static double intensity(char type, luminaire_shape shape, double v, double h)
{
	double a = v * DEGREE, b = h * DEGREE;
	if (type == 'C')
		return shape(sin(a) * cos(b), sin(a) * sin(b), cos(a));
	if (type == 'B')
		return shape(sin(b), cos(b) * sin(a), cos(b) * cos(a));
	return shape(sin(b) * cos(a), sin(a), cos(b) * cos(a));
}

size_t luminaire_file_ies(char *text, char type, const luminaire_grid *grid, luminaire_shape shape)
{
	size_t verticals = count_of(grid->vertical), horizontals = count_of(grid->horizontal);
	size_t used = (size_t)sprintf(text,
								  "IESNA:LM-63-2002\r\n[MANUFAC] Works of M\xc3\xbcller\r\n"
								  "[LUMINAIRE] a function\r\nTILT=NONE\r\n"
								  "1 -1 1 %zu %zu %d 2 1 2 0\r\n1 1 10\r\n",
								  verticals, horizontals,
								  type == 'C'   ? 1
								  : type == 'B' ? 2
												: 3);
	for (size_t i = 0; i < verticals; i++)
		used += (size_t)sprintf(text + used, "%.10g ", angle_of(grid->vertical, i));
	used += (size_t)sprintf(text + used, "\r\n");
	for (size_t i = 0; i < horizontals; i++)
		used += (size_t)sprintf(text + used, "%.10g ", angle_of(grid->horizontal, i));
	for (size_t h = 0; h < horizontals; h++) {
		used += (size_t)sprintf(text + used, "\r\n");
		for (size_t v = 0; v < verticals; v++)
			used += (size_t)sprintf(
				text + used, "%.9g ",
				intensity(type, shape, angle_of(grid->vertical, v), angle_of(grid->horizontal, h)));
	}
	return used + (size_t)sprintf(text + used, "\r\n");
}

size_t luminaire_file_eulumdat(char *text, int symmetry, luminaire_shape shape)
{
	/* First and last plane of 24, by symmetry. */
	static const int plane[5][2] = { { 0, 23 }, { 0, 0 }, { 0, 12 }, { 6, 18 }, { 0, 6 } };
	size_t used = (size_t)sprintf(
		text,
		"M\xfcller\n1\n%d\n24\n15\n73\n2.5\nreport\na function\n1\nfile\ndate\n500\n400\n100\n"
		"300\n200\n0\n0\n0\n0\n100\n80,5\n1\n0\n1\n2\nlamp\n2000\n3000K\n80\n25\n",
		symmetry);
	for (int i = 0; i < 10; i++)
		used += (size_t)sprintf(text + used, "0.5\n");
	for (int c = 0; c < 24; c++)
		used += (size_t)sprintf(text + used, "%d\n", 15 * c);
	for (int g = 0; g < 73; g++)
		used += (size_t)sprintf(text + used, "%g\n", 2.5 * g);
	for (int c = plane[symmetry][0]; c <= plane[symmetry][1]; c++)
		for (int g = 0; g < 73; g++)
			used += (size_t)sprintf(text + used, "%.9g\n",
									0.5 * intensity('C', shape, 2.5 * g, 15.0 * c));
	return used;
}
