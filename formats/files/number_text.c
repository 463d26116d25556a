#include "files/number_text.h"
#include "files/number_chars.h"

#include <math.h>
#include <stdint.h>
#include <string.h>
#include <strings.h>

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
	bool whole; /* neither point nor exponent */
} decimal;

/* As many digits as fit into 64 bits whatever they are: 19. */
#define DIGITS 19

static const uint64_t whole_power[] = { 1,      10,      100,      1000,     10000,
										100000, 1000000, 10000000, 100000000 };

/* Value of eight digits in the bytes of x, each 0 to 9, the first in the lowest byte: pairs, then
 * fours, then all. */
static uint64_t join_digits(uint64_t x)
{
	x = x * 10 + (x >> 8);
	uint64_t even = (x & 0x000000ff000000ffu) * (100 + ((uint64_t)1000000 << 32));
	uint64_t odd = (x >> 16 & 0x000000ff000000ffu) * (1 + ((uint64_t)10000 << 32));
	return (even + odd) >> 32;
}

/* How many digits stand at the start of eight bytes, given as distances from '0': 10 or more sets
 * the highest bit of a byte, and what carries goes to bytes behind it. */
static unsigned leading_digits(uint64_t x)
{
	uint64_t others = ((x + 0x7676767676767676u) | x) & 0x8080808080808080u;
	return others ? (unsigned)__builtin_ctzll(others) / 8 : 8;
}

/* Takes all digits; *mantissa is right while they are no more than DIGITS. */
__attribute__((always_inline)) static inline const char *
take_digits(const char *at, const char *end, uint64_t *mantissa)
{
	while (end - at >= 8 && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__) {
		uint64_t x;
		memcpy(&x, at, sizeof x);
		x ^= 0x3030303030303030u;
		unsigned count = leading_digits(x);
		if (count == 0)
			return at;
		*mantissa = *mantissa * whole_power[count] + join_digits(x << (64 - 8 * count));
		at += count;
		if (count < 8)
			return at;
	}
	for (; at < end && is_digit(*at); at++)
		*mantissa = *mantissa * 10 + (uint64_t)(*at - '0');
	return at;
}

/* More than DIGITS, of which the first may be zeros. */
static uint64_t take_many_digits(const char *at, const char *end, bool *exact)
{
	uint64_t mantissa = 0;
	for (; at < end; at++) {
		if (*at == '.')
			continue;
		if (mantissa < 1000000000000000000u)
			mantissa = mantissa * 10 + (uint64_t)(*at - '0');
		else
			*exact = false;
	}
	return mantissa;
}

/* From the letter of an exponent; returns its bytes, or 0 when no digits follow. */
static size_t take_exponent(const char *text, const char *end, int64_t *exponent)
{
	const char *at = text + 1;
	bool negative = at < end && *at == '-';
	if (at < end && (*at == '-' || *at == '+'))
		at++;
	if (at >= end || !is_digit(*at))
		return 0;
	*exponent = 0;
	for (; at < end && is_digit(*at); at++)
		*exponent = *exponent < 1000000 ? *exponent * 10 + (*at - '0') : *exponent;
	*exponent = negative ? -*exponent : *exponent;
	return (size_t)(at - text);
}

/* Inline, and with nothing of *d behind a pointer, so that it stays in registers. */
__attribute__((always_inline)) static inline decimal take_apart(const char *text, size_t length)
{
	decimal d = { .exact = true, .whole = true };
	uint64_t mantissa = 0;
	const char *at = text, *end = text + length;
	if (at < end && (*at == '-' || *at == '+'))
		d.negative = *at++ == '-';
	const char *first = at;
	at = take_digits(at, end, &mantissa);
	ptrdiff_t digits = at - first;
	if (at < end && *at == '.') {
		const char *point = ++at;
		at = take_digits(at, end, &mantissa);
		d.exponent = point - at;
		digits += at - point;
		d.whole = false;
	}
	if (digits > DIGITS) {
		bool exact = true;
		mantissa = take_many_digits(first, at, &exact);
		d.exact = exact;
	}
	if (digits > 0 && at < end && (*at | 32) == 'e') {
		int64_t exponent;
		size_t used = take_exponent(at, end, &exponent);
		d.exponent += used ? exponent : 0;
		d.whole = d.whole && !used;
		at += used;
	}
	d.mantissa = mantissa;
	d.length = digits > 0 ? (size_t)(at - text) : 0;
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

/*
 * mantissa / 10^power, rounded once: 62 bits of the quotient or more, of which the lowest says
 * whether anything is left behind it, are all that rounding to 53 bits can ask for. power <= 19.
 */
static double divide_exactly(uint64_t mantissa, int64_t power)
{
	uint64_t divisor = 1;
	for (int64_t p = 0; p < power; p++)
		divisor *= 10;
	int up = __builtin_clzll(mantissa), down = __builtin_clzll(divisor);
	unsigned __int128 dividend = (unsigned __int128)(mantissa << up) << 63;
	divisor <<= down;
	uint64_t quotient = (uint64_t)(dividend / divisor);
	bool rest = (unsigned __int128)quotient * divisor != dividend;
	/* A power of two that is a double: from 2^-126 to 2^1. */
	uint64_t scale = (uint64_t)(1023 + down - up - 63) << 52;
	double factor;
	memcpy(&factor, &scale, sizeof factor);
	return (double)(quotient | rest) * factor;
}

/* Both at most 2^53 and 10^22 are doubles without error, so one operation rounds once. */
static inline bool read_exactly(const decimal *d, double *value)
{
	static const double power[] = { 1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
									1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
									1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22 };
	if (!d->exact || d->exponent < -22 || d->exponent > 22)
		return false;
	double m = (double)d->mantissa;
	if (d->mantissa <= (uint64_t)1 << 53)
		m = d->exponent < 0 ? m / power[-d->exponent] : m * power[d->exponent];
	else if (d->exponent < 0 && d->exponent >= -19)
		m = divide_exactly(d->mantissa, -d->exponent);
	else if (d->exponent != 0)
		return false;
	*value = d->negative ? -m : m;
	return true;
}

/* Six digits go through single precision and back unchanged. */
static inline bool is_single(const decimal *d, double value)
{
	uint64_t m = d->mantissa;
	while (m >= 1000000 && m % 10 == 0)
		m /= 10;
	bool in_range = value == 0.0 || (fabs(value) > 1e-37 && fabs(value) < 1e38);
	return d->exact && m < 1000000 && in_range;
}

size_t number_read_form(const char *text, size_t length, double *value, number_form *form)
{
	decimal d = take_apart(text, length);
	bool dressed = d.length > 0 && d.length < length && text[d.length] == '#';
	if (d.length == 0 || dressed) {
		*form = (number_form){ .single = true };
		return read_name(text, length, value);
	}
	if (!read_exactly(&d, value))
		*value = number_from_chars(text, d.length);
	form->whole = d.whole && !(d.negative && d.mantissa == 0);
	form->single = is_single(&d, *value);
	return d.length;
}

size_t number_read(const char *text, size_t length, double *value)
{
	decimal d = take_apart(text, length);
	bool dressed = d.length > 0 && d.length < length && text[d.length] == '#';
	if (d.length == 0 || dressed)
		return read_name(text, length, value);
	if (!read_exactly(&d, value))
		*value = number_from_chars(text, d.length);
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
	if ((halfway || small) && isfinite(wide))
		*value = number_float_from_chars(text, used);
	return used;
}

/* ------------------------------------------------------------------------------ printing */

/* Writes digits * 10^-decimals, with a digit before the point. */
static size_t print_fixed(char *text, bool negative, uint64_t digits, int decimals)
{
	char reversed[NUMBER_TEXT];
	int count = 0;
	for (int place = 0; digits > 0 || place <= decimals; digits /= 10, place++) {
		if (place == decimals && decimals > 0)
			reversed[count++] = '.';
		reversed[count++] = (char)('0' + digits % 10);
	}
	size_t length = 0;
	if (negative)
		text[length++] = '-';
	while (count > 0)
		text[length++] = reversed[--count];
	text[length] = '\0';
	return length;
}

/*
 * The quick way, for numbers of at most 15 digits, or 9 of single precision: whole / 10^decimals is
 * what reading the text computes, so the first number of decimals that gives the value is the
 * shortest text. Returns 0 when there is none, or when an exponent would be shorter.
 */
static size_t print_quickly(char *text, double value, bool single)
{
	static const double power[] = { 1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,
									1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19 };
	double size = fabs(value), limit = single ? 1e9 : 1e15;
	if (value == 0.0)
		return print_fixed(text, signbit(value), 0, 0);
	if (!(size >= 1e-4 && size < (single ? 1e6 : 1e15)))
		return 0;
	for (int decimals = 0; decimals < 20; decimals++) {
		double whole = nearbyint(size * power[decimals]);
		if (whole >= limit)
			return 0;
		double back = whole / power[decimals];
		uint64_t bits;
		memcpy(&bits, &back, sizeof bits);
		bool halfway = single && (bits & 0x1fffffff) == 0x10000000;
		if (!halfway && (single ? (double)(float)back : back) == size)
			return print_fixed(text, value < 0.0, (uint64_t)whole, decimals);
	}
	return 0;
}

size_t number_print(char *text, double value)
{
	size_t length = print_quickly(text, value, false);
	return length ? length : number_to_chars(text, value);
}

size_t number_print_float(char *text, float value)
{
	size_t length = print_quickly(text, (double)value, true);
	return length ? length : number_float_to_chars(text, value);
}
