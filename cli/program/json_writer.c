#include "program/json_writer.h"
#include "files/number_text.h"
#include "program/text_quote.h"

#include <inttypes.h>
#include <math.h>

static void begin(json_writer *json, const char *key)
{
	bool flat = !json->lines || (json->flat && json->depth >= json->flat);
	if (json->comma)
		fputs(flat ? ", " : ",", json->out);
	if (!flat && json->depth > 0)
		fprintf(json->out, "\n%*s", json->depth, "");
	if (key) {
		text_quote_json(json->out, key);
		fputs(": ", json->out);
	}
	json->comma = true;
}

void json_put_open(json_writer *json, const char *key, char bracket)
{
	begin(json, key);
	fputc(bracket, json->out);
	json->depth++;
	json->comma = false;
}

void json_put_open_flat(json_writer *json, const char *key, char bracket)
{
	json_put_open(json, key, bracket);
	if (!json->flat)
		json->flat = json->depth;
}

void json_put_close(json_writer *json, char bracket)
{
	bool flat = !json->lines || (json->flat && json->depth >= json->flat);
	if (json->flat == json->depth)
		json->flat = 0;
	json->depth--;
	if (!flat && json->comma)
		fprintf(json->out, "\n%*s", json->depth, "");
	fputc(bracket, json->out);
	json->comma = true;
}

void json_put_text(json_writer *json, const char *key, const char *value)
{
	begin(json, key);
	text_quote_json(json->out, value);
}

void json_put_bool(json_writer *json, const char *key, bool value)
{
	begin(json, key);
	fputs(value ? "true" : "false", json->out);
}

void json_put_count(json_writer *json, const char *key, uint64_t value)
{
	begin(json, key);
	fprintf(json->out, "%" PRIu64, value);
}

void json_put_real(json_writer *json, const char *key, double value)
{
	char text[NUMBER_TEXT];
	begin(json, key);
	number_print(text, value);
	fputs(isfinite(value) ? text : "null", json->out);
}

void json_put_single(json_writer *json, const char *key, float value)
{
	char text[NUMBER_TEXT];
	begin(json, key);
	number_print_float(text, value);
	fputs(isfinite(value) ? text : "null", json->out);
}

void json_put_reals(json_writer *json, const char *key, const double *value, size_t count)
{
	json_put_open_flat(json, key, '[');
	for (size_t i = 0; i < count; i++)
		json_put_real(json, NULL, value[i]);
	json_put_close(json, ']');
}

void json_put_singles(json_writer *json, const char *key, const float *value, size_t count)
{
	json_put_open_flat(json, key, '[');
	for (size_t i = 0; i < count; i++)
		json_put_single(json, NULL, value[i]);
	json_put_close(json, ']');
}
