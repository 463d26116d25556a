/* say_number.c - numbers as people write them; see gw_say_number in glowworm_host.h. */
#include "glowworm_host.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LEAST 1e-6 /* that is written without an exponent */
#define MOST 1e15  /* and below that */

static const struct {
	double one;
	const char *name;
} large[] = { { 1e12, "trillion" }, { 1e9, "billion" }, { 1e6, "million" } };

/* Zeros behind the last digit of a fraction say nothing, nor those before that of an exponent. */
static void leave_out(char *text)
{
	char *exponent = strchr(text, 'e');
	if (exponent) {
		char *digits = exponent + 1 + (exponent[1] == '-');
		memmove(digits, digits + strspn(digits, "+0"), strlen(digits + strspn(digits, "+0")) + 1);
	}
	if (exponent || !strpbrk(text, ".,"))
		return;
	char *end = text + strlen(text);
	while (end[-1] == '0')
		end--;
	if (end[-1] == '.' || end[-1] == ',')
		end--;
	*end = '\0';
}

/* Whether so many of a large one are said with three digits behind the point at most. */
static bool is_short(double count)
{
	return count >= 1.0 && count < 1000.0 && fabs(count * 1e3 - rint(count * 1e3)) < 1e-9;
}

/* Rounds to so many digits, and tells the power of ten; NAN where there is none. */
static double round_to(double value, int digits, int *power, char text[GW_SAID_NUMBER])
{
	snprintf(text, GW_SAID_NUMBER, "%.*e", digits - 1, isnan(value) ? fabs(value) : value);
	const char *behind = strchr(text, 'e');
	*power = behind ? (int)strtol(behind + 1, NULL, 10) : 0;
	return behind ? strtod(text, NULL) : NAN;
}

/* With digits alone, if it is not too large or small. */
static const char *print_digits(double value, int digits, char text[GW_SAID_NUMBER])
{
	int power;
	double rounded = round_to(value, digits, &power, text), size = fabs(rounded);
	int behind = digits - 1 - power;
	if (isnan(rounded)) /* or infinite */
		return text;
	if (size < MOST && (size >= LEAST || size == 0.0))
		snprintf(text, GW_SAID_NUMBER, "%.*f", behind > 0 ? behind : 0, rounded);
	else
		snprintf(text, GW_SAID_NUMBER, "%.*g", digits, rounded);
	leave_out(text);
	return text;
}

const char *gw_say_number(double value, int digits, char text[GW_SAID_NUMBER])
{
	int power, most = digits < 1 ? 1 : digits < 15 ? digits : 15;
	double rounded = round_to(value, most, &power, text);
	for (size_t i = 0; i < sizeof large / sizeof *large; i++) {
		double count = rounded / large[i].one;
		if (!is_short(fabs(count)))
			continue;
		snprintf(text, GW_SAID_NUMBER, "%.3f", count);
		leave_out(text);
		snprintf(text + strlen(text), GW_SAID_NUMBER - strlen(text), " %s", large[i].name);
		return text;
	}
	return print_digits(value, most, text);
}

const char *gw_say_place(double value, char text[GW_SAID_NUMBER])
{
	int power;
	(void)round_to(value, 6, &power, text);
	int digits = power + 4 > 6 ? power + 4 : 6;
	return print_digits(value, digits < 15 ? digits : 15, text);
}
