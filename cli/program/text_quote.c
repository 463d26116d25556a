#include "program/text_quote.h"
#include "files/utf8_text.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

void text_quote(FILE *out, const char *word)
{
	static const char safe[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
							   "@%+=:,./_-";
	if (*word && strspn(word, safe) == strlen(word)) {
		fputs(word, out);
		return;
	}
	fputc('\'', out);
	for (const char *c = word; *c; c++) {
		if (*c == '\'')
			fputs("'\\''", out);
		else
			fputc(*c, out);
	}
	fputc('\'', out);
}

void text_quote_json(FILE *out, const char *text)
{
	fputc('"', out);
	for (const unsigned char *c = (const unsigned char *)text; *c;) {
		size_t length = utf8_length(c);
		if (length == 0)
			fputs("\\ufffd", out);
		else if (*c == '"' || *c == '\\')
			fprintf(out, "\\%c", *c);
		else if (*c < 0x20 || *c == 0x7f)
			fprintf(out, "\\u%04x", *c);
		else
			fwrite(c, 1, length, out);
		c += length ? length : 1;
	}
	fputc('"', out);
}

/* Copies a message with its control characters and broken bytes as \xNN; 4 bytes a byte are room
 * enough. Returns the end. */
static char *escape_message(char *to, const char *text)
{
	for (const unsigned char *c = (const unsigned char *)text; *c;) {
		size_t length = utf8_length(c);
		bool last = *c == '\n' && !c[1];
		bool control = *c < 0x20 || *c == 0x7f || (*c == 0xc2 && length == 2 && c[1] < 0xa0);
		bool plain = length > 0 && (last || !control);
		for (size_t left = length ? length : 1; left > 0; left--, c++)
			if (plain)
				*to++ = (char)*c;
			else
				to += snprintf(to, 5, "\\x%02x", *c);
	}
	return to;
}

void text_message(FILE *out, const char *format, ...)
{
	char *text = NULL, *escaped = NULL;
	va_list arguments;
	va_start(arguments, format);
	if (vasprintf(&text, format, arguments) < 0)
		text = NULL;
	va_end(arguments);
	if (text)
		escaped = calloc(strlen(text) + 1, 4);
	/* At once: standard error has no buffer, and other processes may write lines to it. */
	if (escaped)
		fwrite(escaped, 1, (size_t)(escape_message(escaped, text) - escaped), out);
	else
		fputs("glowworm: no memory for a message\n", out);
	free(escaped);
	free(text);
}

const char *text_percent(double share, char text[TEXT_PERCENT])
{
	double percent = 100.0 * share, size = fabs(percent);
	/* Less is a rounding of nothing. */
	if (size < 1e-9)
		percent = size = 0.0;
	if (!isfinite(percent) || !(size >= 1e-9 && size < 1e15)) {
		snprintf(text, TEXT_PERCENT, "%g", percent);
		return text;
	}
	/* Rounded first: 99.6 has three digits. */
	snprintf(text, TEXT_PERCENT, "%.1e", percent);
	int decimals = 1 - (int)strtol(strchr(text, 'e') + 1, NULL, 10);
	snprintf(text, TEXT_PERCENT, "%.*f", decimals > 0 ? decimals : 0, strtod(text, NULL));
	if (decimals > 0) {
		size_t length = strlen(text);
		while (text[length - 1] == '0')
			text[--length] = '\0';
		if (text[length - 1] == '.')
			text[length - 1] = '\0';
	}
	return text;
}
