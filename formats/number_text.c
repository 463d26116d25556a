#include "number_text.h"

#include <locale.h>
#include <math.h>
#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static locale_t c_locale; /* (locale_t)0 when the system could not make one: then the current one */
static pthread_once_t c_locale_once = PTHREAD_ONCE_INIT;

static void make_c_locale(void)
{
	c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
}

static bool is_digit(char c)
{
	return c >= '0' && c <= '9';
}

/* ------------------------------------------------------------------------------- reading */

/* A decimal number taken apart. */
typedef struct decimal {
	size_t length;     /* of the text; 0 when it is no number */
	uint64_t mantissa; /* its digits without the point, when exact */
	int64_t exponent;  /* power of ten of the last digit of the mantissa */
	bool exact;        /* mantissa holds all digits */
	bool negative;
} decimal;

static void take_digits(const char *text, size_t length, size_t *at, bool fraction, size_t *digits,
						decimal *d)
{
	for (; *at < length && is_digit(text[*at]); ++*at, ++*digits) {
		uint64_t digit = (uint64_t)(text[*at] - '0');
		if (__builtin_mul_overflow(d->mantissa, 10, &d->mantissa) ||
			__builtin_add_overflow(d->mantissa, digit, &d->mantissa))
			d->exact = false;
		if (fraction)
			d->exponent--;
	}
}

/* The exponent is taken only when digits follow its letter. */
static void take_exponent(const char *text, size_t length, size_t *at, decimal *d)
{
	size_t i = *at;
	if (i >= length || (text[i] != 'e' && text[i] != 'E'))
		return;
	i++;
	bool negative = i < length && text[i] == '-';
	if (i < length && (text[i] == '-' || text[i] == '+'))
		i++;
	if (i >= length || !is_digit(text[i]))
		return;
	int64_t exponent = 0;
	for (; i < length && is_digit(text[i]); i++)
		exponent = exponent < 1000000 ? exponent * 10 + (text[i] - '0') : exponent;
	d->exponent += negative ? -exponent : exponent;
	*at = i;
}

static decimal take_apart(const char *text, size_t length)
{
	decimal d = { .exact = true };
	size_t at = 0, digits = 0;
	if (at < length && (text[at] == '-' || text[at] == '+'))
		d.negative = text[at++] == '-';
	take_digits(text, length, &at, false, &digits, &d);
	if (at < length && text[at] == '.') {
		at++;
		take_digits(text, length, &at, true, &digits, &d);
	}
	if (digits == 0)
		return (decimal){ 0 };
	take_exponent(text, length, &at, &d);
	d.length = at;
	return d;
}

/* inf, nan and their spellings. */
static size_t read_name(const char *text, size_t length, double *value)
{
	static const struct {
		const char *name;
		double value;
	} names[] = { { "infinity", INFINITY }, { "inf", INFINITY }, { "nan(ind)", NAN },
				  { "nan(snan)", NAN },     { "nan", NAN },      { "1.#INF", INFINITY },
				  { "1.#QNAN", NAN },       { "1.#SNAN", NAN },  { "1.#IND", NAN } };
	size_t sign = length > 0 && (text[0] == '-' || text[0] == '+');
	for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
		size_t size = strlen(names[i].name);
		if (length - sign < size || strncasecmp(text + sign, names[i].name, size) != 0)
			continue;
		size_t end = sign + size;
		if (strchr(names[i].name, '#')) /* Microsoft pads these with zeros: 1.#INF00 */
			while (end < length && is_digit(text[end]))
				end++;
		*value = text[0] == '-' ? -names[i].value : names[i].value;
		return end;
	}
	return 0;
}

/* Both at most 2^53 and 10^22 are doubles without error, so one operation rounds once. */
static bool read_exactly(const decimal *d, double *value)
{
	static const double power[] = { 1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
									1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
									1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22 };
	if (!d->exact || d->mantissa > (uint64_t)1 << 53 || d->exponent < -22 || d->exponent > 22)
		return false;
	double m = (double)d->mantissa;
	m = d->exponent < 0 ? m / power[-d->exponent] : m * power[d->exponent];
	*value = d->negative ? -m : m;
	return true;
}

/* The slow way: the C library's conversion needs a final zero, therefore a copy. */
static bool read_by_library(const char *text, size_t length, double *value, float *single)
{
	char local[256], *copy = length < sizeof local ? local : malloc(length + 1);
	if (!copy)
		return false;
	memcpy(copy, text, length);
	copy[length] = '\0';
	pthread_once(&c_locale_once, make_c_locale);
	if (single)
		*single = c_locale ? strtof_l(copy, NULL, c_locale) : strtof(copy, NULL);
	else
		*value = c_locale ? strtod_l(copy, NULL, c_locale) : strtod(copy, NULL);
	if (copy != local)
		free(copy);
	return true;
}

size_t number_read(const char *text, size_t length, double *value)
{
	decimal d = take_apart(text, length);
	bool dressed = d.length > 0 && d.length < length && text[d.length] == '#';
	if (d.length == 0 || dressed)
		return read_name(text, length, value);
	if (!read_exactly(&d, value) && !read_by_library(text, d.length, value, NULL))
		return 0;
	return d.length;
}

size_t number_read_float(const char *text, size_t length, float *value)
{
	double wide;
	size_t used = number_read(text, length, &wide);
	if (used == 0)
		return 0;
	*value = (float)wide;
	/* The detour over double errs only when the double lies half-way between two floats, or
	 * where floats have fewer bits. */
	uint64_t bits;
	memcpy(&bits, &wide, sizeof bits);
	bool halfway = (bits & 0x1fffffff) == 0x10000000;
	bool small = wide != 0.0 && fabs(wide) < 1.2e-38;
	if ((halfway || small) && isfinite(wide) && !read_by_library(text, used, NULL, value))
		return 0;
	return used;
}

/* ------------------------------------------------------------------------------ printing */

static size_t print_with(char *text, double value, bool single)
{
	if (isnan(value))
		return (size_t)snprintf(text, NUMBER_TEXT, "nan");
	pthread_once(&c_locale_once, make_c_locale);
	locale_t before = c_locale ? uselocale(c_locale) : (locale_t)0;
	int length = 0;
	int first = single ? 6 : 15, last = single ? 9 : 17;
	for (int precision = first; precision <= last; precision++) {
		length = snprintf(text, NUMBER_TEXT, "%.*g", precision, value);
		bool same = single ? strtof(text, NULL) == (float)value : strtod(text, NULL) == value;
		if (same)
			break;
	}
	if (before)
		uselocale(before);
	return (size_t)length;
}

size_t number_print(char *text, double value)
{
	return print_with(text, value, false);
}

size_t number_print_float(char *text, float value)
{
	return print_with(text, (double)value, true);
}
