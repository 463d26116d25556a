#include "e57/e57_pages.h"
#include "glowworm_host.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* Castagnoli's polynomial, bits reversed; table[k] is for bytes k places before the last of 4. */
static uint32_t table[4][256];
static pthread_once_t table_once = PTHREAD_ONCE_INIT;

static void make_table(void)
{
	for (uint32_t b = 0; b < 256; b++) {
		uint32_t sum = b;
		for (int i = 0; i < 8; i++)
			sum = sum >> 1 ^ (sum & 1 ? 0x82f63b78u : 0);
		table[0][b] = sum;
	}
	for (uint32_t b = 0; b < 256; b++)
		for (int k = 1; k < 4; k++)
			table[k][b] = table[k - 1][b] >> 8 ^ table[0][table[k - 1][b] & 255];
}

/* CRC-32C of a page's content. */
static uint32_t checksum(const uint8_t *bytes)
{
	uint32_t sum = UINT32_MAX;
	for (size_t i = 0; i < E57_CONTENT; i += 4) {
		sum ^= (uint32_t)e57_load(bytes + i, 4);
		sum = table[3][sum & 255] ^ table[2][sum >> 8 & 255] ^ table[1][sum >> 16 & 255] ^
			  table[0][sum >> 24];
	}
	return ~sum;
}

uint32_t e57_page_checksum(const uint8_t *content)
{
	pthread_once(&table_once, make_table);
	return checksum(content);
}

typedef struct checking {
	const input_file *in;
	atomic_size_t bad; /* the first page with another checksum */
} checking;

static void check_pages(void *user, size_t first, size_t last, uint32_t worker)
{
	(void)worker;
	checking *c = user;
	for (size_t p = first; p < last; p++) {
		const uint8_t *from = c->in->data + p * E57_PAGE;
		uint32_t stored = __builtin_bswap32((uint32_t)e57_load(from + E57_CONTENT, 4));
		size_t before = atomic_load(&c->bad);
		if (checksum(from) != stored)
			while (p < before && !atomic_compare_exchange_weak(&c->bad, &before, p))
				;
	}
	input_file_release(c->in, c->in->data + first * E57_PAGE, c->in->data + last * E57_PAGE);
}

static gw_status check_header(const input_file *in, gw_error *error)
{
	const uint8_t *head = in->data;
	if (in->length < E57_HEADER || memcmp(head, "ASTM-E57", 8) != 0)
		return gw_fail(error, GW_ERROR_DATA,
					   "%s is no E57 file: it does not begin with 'ASTM-E57' and a header of 48 "
					   "bytes",
					   in->name);
	uint64_t major = e57_load(head + 8, 4), length = e57_load(head + 16, 8);
	uint64_t page = e57_load(head + 40, 8);
	if (major != 1)
		return gw_fail(error, GW_ERROR_DATA,
					   "%s is of version %llu of E57; only version 1 is known", in->name,
					   (unsigned long long)major);
	if (page != E57_PAGE)
		return gw_fail(error, GW_ERROR_DATA, "%s has pages of %llu bytes; in E57 they have 1024",
					   in->name, (unsigned long long)page);
	if (length != in->length || length % E57_PAGE != 0)
		return gw_fail(error, GW_ERROR_DATA,
					   "%s has %zu bytes, but its header says %llu, in pages of 1024; the file is "
					   "cut short or damaged",
					   in->name, in->length, (unsigned long long)length);
	return GW_OK;
}

static gw_status check_all(const input_file *in, gw_error *error)
{
	checking c = { .in = in, .bad = SIZE_MAX };
	gw_parallel_for(in->threads, in->length / E57_PAGE, 1024, check_pages, &c);
	size_t bad = atomic_load(&c.bad);
	if (bad != SIZE_MAX)
		return gw_fail(error, GW_ERROR_DATA,
					   "%s, bytes %zu to %zu: the checksum of this page is wrong; the file is "
					   "damaged",
					   in->name, bad * E57_PAGE, bad * E57_PAGE + E57_PAGE - 1);
	return GW_OK;
}

gw_status e57_pages_open(e57_pages *pages, const input_file *in, gw_error *error)
{
	*pages = (e57_pages){ .in = NULL };
	GW_TRY(check_header(in, error));
	e57_pages all = { .in = in, .length = in->length / E57_PAGE * E57_CONTENT };
	uint64_t xml = e57_load(in->data + 24, 8), length = e57_load(in->data + 32, 8);
	if (!e57_pages_locate(&all, xml, &all.xml) || length > all.length - all.xml)
		return gw_fail(error, GW_ERROR_DATA,
					   "%s: the description should stand at byte %llu, %llu bytes long, which is "
					   "beyond the end; the header is damaged",
					   in->name, (unsigned long long)xml, (unsigned long long)length);
	all.xml_length = (size_t)length;
	*pages = all;
	return GW_OK;
}

gw_status e57_pages_check(const e57_pages *pages, gw_error *error)
{
	pthread_once(&table_once, make_table);
	return check_all(pages->in, error);
}

void e57_pages_copy(const e57_pages *pages, size_t at, size_t length, void *to)
{
	uint8_t *next = to;
	while (length > 0) {
		size_t within = at % E57_CONTENT, left = E57_CONTENT - within;
		size_t size = length < left ? length : left;
		memcpy(next, pages->in->data + at / E57_CONTENT * E57_PAGE + within, size);
		next += size;
		at += size;
		length -= size;
	}
}

bool e57_pages_locate(const e57_pages *pages, uint64_t offset, size_t *at)
{
	uint64_t within = offset % E57_PAGE, page = offset / E57_PAGE;
	if (within >= E57_CONTENT || page >= pages->length / E57_CONTENT)
		return false;
	*at = (size_t)(page * E57_CONTENT + within);
	return true;
}
