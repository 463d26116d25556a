#include "e57_file.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

typedef struct bytes {
	uint8_t *data;
	size_t length;
} bytes;

static void put_number(bytes *b, uint64_t value, size_t size)
{
	for (size_t i = 0; i < size; i++)
		b->data[b->length++] = (uint8_t)(value >> 8 * i);
}

/* ------------------------------------------------------------------------------- records */

enum { FIELDS = 8, RECORDS = 5 };

/* Bits of one value of a field of the first scan. */
static uint64_t value_of(int field, int i)
{
	float y = (float)i + 0.5f;
	double z = -i / 8.0;
	uint32_t y_bits;
	uint64_t z_bits;
	memcpy(&y_bits, &y, sizeof y);
	memcpy(&z_bits, &z, sizeof z);
	switch (field) {
	case 0:
		return (uint64_t)(i * 250 + 100); /* of -100 to 1000, counted from -100 */
	case 1:
		return y_bits;
	case 2:
		return z_bits;
	case 7:
		return i == 2 ? 1 : 0;
	default:
		return (uint64_t)(i * 50 + field);
	}
}

/* A field's values as a stream of bits, the lowest first. Returns its bytes. */
static size_t put_stream(uint8_t *to, int field)
{
	static const unsigned width[FIELDS] = { 11, 32, 64, 0, 8, 8, 8, 2 };
	size_t bit = 0;
	memset(to, 0, 64);
	for (int i = 0; i < RECORDS; i++)
		for (unsigned k = 0; k < width[field]; k++, bit++)
			to[bit / 8] = (uint8_t)(to[bit / 8] | (value_of(field, i) >> k & 1) << bit % 8);
	return (bit + 7) / 8;
}

/* Bytes [from, to) percent of every stream. */
static void put_packet(bytes *b, size_t from, size_t to)
{
	uint8_t stream[FIELDS][64];
	size_t first[FIELDS], size[FIELDS], start = b->length;
	put_number(b, 1, 2);
	put_number(b, 0, 2);
	put_number(b, FIELDS, 2);
	for (int f = 0; f < FIELDS; f++) {
		size_t all = put_stream(stream[f], f);
		first[f] = all * from / 100;
		size[f] = all * to / 100 - first[f];
		put_number(b, size[f], 2);
	}
	for (int f = 0; f < FIELDS; f++) {
		memcpy(b->data + b->length, stream[f] + first[f], size[f]);
		b->length += size[f];
	}
	while ((b->length - start) % 4)
		put_number(b, 0, 1);
	b->data[start + 2] = (uint8_t)(b->length - start - 1);
}

/* Section header; its length is filled in by end_section. All lies in the first page. */
static size_t begin_section(bytes *b)
{
	size_t start = b->length;
	put_number(b, 1, 8);
	put_number(b, 0, 8);
	put_number(b, start + 32, 8);
	put_number(b, 0, 8);
	return start;
}

static void end_section(bytes *b, size_t start)
{
	bytes length = { b->data + start + 8, 0 };
	put_number(&length, b->length - start, 8);
}

static void put_spheres(bytes *b)
{
	static const float value[3][2] = { { 2, 4 }, { 0, 1.5f }, { 0, -0.5f } };
	put_number(b, 1, 2);
	put_number(b, 6 + 6 + 24 - 1, 2);
	put_number(b, 3, 2);
	for (int f = 0; f < 3; f++)
		put_number(b, 8, 2);
	for (int f = 0; f < 3; f++) {
		memcpy(b->data + b->length, value[f], 8);
		b->length += 8;
	}
}

/* ---------------------------------------------------------------------------- description */

static void put_description(bytes *b, size_t first, size_t second)
{
	b->length += (size_t)sprintf(
		(char *)b->data + b->length,
		"<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<e57Root type=\"Structure\">"
		"<data3D type=\"Vector\">\n<vectorChild type=\"Structure\">"
		"<pose type=\"Structure\"><rotation type=\"Structure\"><w type=\"Float\">1</w>"
		"<x type=\"Float\"/><y type=\"Float\">0.0</y><z type=\"Float\"> 1e0 </z></rotation>"
		"<translation type=\"Structure\"><x type=\"Float\">1000</x><y type=\"Float\">2000</y>"
		"<z type=\"Float\">3000</z></translation></pose>\n"
		"<points type=\"CompressedVector\" fileOffset=\"%zu\" recordCount=\"5\">"
		"<prototype type=\"Structure\">\n<cartesianX type=\"ScaledInteger\" minimum=\"-100\" "
		"maximum=\"1000\" scale=\"0.001\" offset=\"5\"/>"
		"<cartesianY type=\"Float\" precision=\"single\"/><cartesianZ type=\"Float\"/>"
		"<intensity type=\"Integer\" minimum=\"7\" maximum=\"7\"/>\n"
		"<colorRed type=\"Integer\" minimum=\"0\" maximum=\"255\"/>"
		"<colorGreen type=\"Integer\" minimum=\"0\" maximum=\"255\"/>"
		"<colorBlue type=\"Integer\" minimum=\"0\" maximum=\"255\"/>\n"
		"<cartesianInvalidState type=\"Integer\" minimum=\"0\" maximum=\"2\"/>"
		"</prototype></points></vectorChild>\n<vectorChild type=\"Structure\">"
		"<points type=\"CompressedVector\" fileOffset=\"%zu\" recordCount=\"2\">"
		"<prototype type=\"Structure\"><sphericalRange type=\"Float\" precision=\"single\"/>"
		"<sphericalAzimuth type=\"Float\" precision=\"single\"/>"
		"<sphericalElevation type=\"Float\" precision=\"single\"/></prototype></points>"
		"</vectorChild></data3D></e57Root>\n",
		first, second);
}

size_t e57_file_content(uint8_t *content, size_t *xml)
{
	bytes b = { content, 0 };
	memset(content, 0, E57_FILE_ROOM);
	memcpy(content, "ASTM-E57\001", 9);
	content[41] = 1024 / 256;
	b.length = 48;
	size_t first = begin_section(&b);
	put_packet(&b, 0, 40);
	put_number(&b, 0, 2); /* an index, which readers step over */
	put_number(&b, 16 - 1, 2);
	put_number(&b, 0, 8);
	put_number(&b, 0, 4);
	put_packet(&b, 40, 100);
	end_section(&b, first);
	size_t second = begin_section(&b);
	put_spheres(&b);
	end_section(&b, second);
	*xml = b.length;
	put_description(&b, first, second);
	return b.length;
}

/* ---------------------------------------------------------------------------------- pages */

/* CRC-32C, bit by bit. */
static uint32_t checksum(const uint8_t *data, size_t length)
{
	uint32_t sum = UINT32_MAX;
	for (size_t i = 0; i < length; i++) {
		sum ^= data[i];
		for (int k = 0; k < 8; k++)
			sum = sum >> 1 ^ (sum & 1 ? 0x82f63b78u : 0);
	}
	return ~sum;
}

size_t e57_file_pages(const uint8_t *content, size_t length, size_t xml, uint8_t *file)
{
	size_t pages = (length + 1019) / 1020;
	for (size_t p = 0; p < pages; p++) {
		uint8_t *page = file + 1024 * p;
		size_t size = length - 1020 * p < 1020 ? length - 1020 * p : 1020;
		memset(page, ' ', 1020);
		memcpy(page, content + 1020 * p, size);
		if (p == 0 && size >= 48 && length >= xml) {
			bytes head = { page, 16 };
			put_number(&head, 1024 * pages, 8);
			put_number(&head, xml / 1020 * 1024 + xml % 1020, 8);
			put_number(&head, length - xml, 8);
		}
		uint32_t sum = checksum(page, 1020);
		for (int k = 0; k < 4; k++)
			page[1020 + k] = (uint8_t)(sum >> (24 - 8 * k));
	}
	return 1024 * pages;
}
