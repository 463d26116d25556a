/* number_chars.cpp - see number_chars.h. */
#include "files/number_chars.h"

#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

/* Which way a number left the range: whether its first digit that is not 0 stands for more than 1.
 * What is out of range at all is so by far more than the exponents that are cut off here. */
static bool is_large(const char *at, const char *end)
{
	long place = 0;
	bool found = false, behind_point = false;
	for (; at < end && (*at | 32) != 'e'; at++) {
		if (*at == '.')
			behind_point = true;
		else if (found || *at != '0') {
			place += !behind_point && found;
			found = true;
		} else
			place -= behind_point;
	}
	long exponent = 0;
	if (at < end)
		at += at + 1 < end && at[1] == '+' ? 2 : 1;
	if (at < end && std::from_chars(at, end, exponent).ec != std::errc())
		return *at != '-';
	return exponent > -place;
}

template <typename T> static T from_chars(const char *text, size_t length)
{
	const char *end = text + length;
	bool negative = *text == '-';
	text += negative || *text == '+';
	T value = 0;
	if (std::from_chars(text, end, value).ec == std::errc::result_out_of_range)
		value = is_large(text, end) ? std::numeric_limits<T>::infinity() : T(0);
	return negative ? -value : value;
}

template <typename T> static size_t to_chars(char *text, T value, T fixed_below)
{
	T size = std::fabs(value);
	if (std::isnan(value))
		std::memcpy(text, "nan", sizeof "nan");
	else if (size >= T(1e-4) && size < fixed_below)
		*std::to_chars(text, text + NUMBER_TEXT - 1, value, std::chars_format::fixed).ptr = 0;
	else if (size >= T(1e15)) /* integers of so many digits overflow those who read them as such */
		*std::to_chars(text, text + NUMBER_TEXT - 1, value, std::chars_format::scientific).ptr = 0;
	else
		*std::to_chars(text, text + NUMBER_TEXT - 1, value).ptr = 0;
	return std::strlen(text);
}

double number_from_chars(const char *text, size_t length)
{
	return from_chars<double>(text, length);
}

float number_float_from_chars(const char *text, size_t length)
{
	return from_chars<float>(text, length);
}

size_t number_to_chars(char *text, double value)
{
	return to_chars<double>(text, value, 1e15);
}

size_t number_float_to_chars(char *text, float value)
{
	return to_chars<float>(text, value, 1e6f);
}
