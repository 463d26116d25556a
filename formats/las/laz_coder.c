#include "las/laz_coder.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#define INTERVAL_MIN ((uint32_t)1 << 24) /* a shorter interval takes in another byte */
#define MODEL_BITS 15
#define BIT_MODEL_BITS 13
#define BLOCK_BYTES ((size_t)1 << 15)

struct laz_block {
	struct laz_block *next;
	size_t used;
	_Alignas(max_align_t) uint8_t bytes[BLOCK_BYTES];
};

struct laz_model {
	uint32_t symbols;
	uint32_t total;
	uint32_t cycle, left; /* symbols between updates, and until the next one */
	uint32_t table_bits;  /* 0: no table */
	uint16_t *start;      /* where in 2^15 each symbol begins */
	uint16_t *count;
	uint16_t *table; /* for equal steps of 2^15 the symbol at the step's beginning */
};

/* ------------------------------------------------------------------------------------ pool */

void laz_pool_clear(laz_pool *pool)
{
	while (pool->first) {
		struct laz_block *next = pool->first->next;
		free(pool->first);
		pool->first = next;
	}
	*pool = (laz_pool){ 0 };
}

void laz_pool_reset(laz_pool *pool)
{
	for (struct laz_block *block = pool->first; block; block = block->next)
		block->used = 0;
	pool->current = pool->first;
}

/* Memory that is not set; NULL and pool->failed when there is none. bytes: below BLOCK_BYTES */
static void *take(laz_pool *pool, size_t bytes)
{
	bytes = (bytes + sizeof(max_align_t) - 1) / sizeof(max_align_t) * sizeof(max_align_t);
	struct laz_block *block = pool->current;
	if (block && BLOCK_BYTES - block->used < bytes)
		block = pool->current = block->next ? block->next : NULL;
	if (!block) {
		block = malloc(sizeof *block);
		if (!block) {
			pool->failed = true;
			return NULL;
		}
		block->used = 0;
		block->next = NULL;
		struct laz_block **last = &pool->first;
		while (*last)
			last = &(*last)->next;
		*last = pool->current = block;
	}
	void *memory = block->bytes + block->used;
	block->used += bytes;
	return memory;
}

/* ---------------------------------------------------------------------------------- models */

/* From counts to the symbols' shares of 2^15, and how long they shall hold. */
static void update_model(laz_model *m)
{
	m->total += m->cycle;
	if (m->total > (uint32_t)1 << MODEL_BITS) {
		m->total = 0;
		for (uint32_t s = 0; s < m->symbols; s++) {
			m->count[s] = (uint16_t)((m->count[s] + 1) / 2);
			m->total += m->count[s];
		}
	}
	assert(m->total > 0); /* the cycle is, and so is a count */
	uint32_t sum = 0, scale = 0x80000000u / m->total;
	for (uint32_t s = 0; s < m->symbols; s++) {
		m->start[s] = (uint16_t)(scale * sum >> (31 - MODEL_BITS));
		sum += m->count[s];
	}
	if (m->table_bits) {
		uint32_t symbol = 0, steps = (uint32_t)1 << m->table_bits;
		for (uint32_t t = 0; t < steps; t++) {
			uint32_t first = t << (MODEL_BITS - m->table_bits);
			while (symbol + 1 < m->symbols && m->start[symbol + 1] <= first)
				symbol++;
			m->table[t] = (uint16_t)symbol;
		}
		m->table[steps] = (uint16_t)(m->symbols - 1);
	}
	uint32_t longest = (m->symbols + 6) * 8;
	m->cycle = m->cycle * 5 / 4;
	m->cycle = m->cycle < longest ? m->cycle : longest;
	m->left = m->cycle;
}

/* searched: symbols are looked for, which a table makes quick. */
static laz_model *make_model(laz_pool *pool, uint32_t symbols, bool searched)
{
	uint32_t table_bits = 0;
	if (searched && symbols > 16)
		for (table_bits = 3; symbols > (uint32_t)4 << table_bits;)
			table_bits++;
	size_t table = table_bits ? ((size_t)1 << table_bits) + 1 : 0;
	laz_model *m = take(pool, sizeof *m + (2 * (size_t)symbols + table) * sizeof *m->start);
	if (!m)
		return NULL;
	*m = (laz_model){ .symbols = symbols, .cycle = symbols, .table_bits = table_bits };
	m->start = (uint16_t *)(m + 1);
	m->count = m->start + symbols;
	m->table = m->count + symbols;
	for (uint32_t s = 0; s < symbols; s++)
		m->count[s] = 1;
	update_model(m);
	m->cycle = m->left = (symbols + 6) / 2;
	return m;
}

static void update_bit_model(laz_bit_model *m)
{
	m->total += m->cycle;
	if (m->total > (uint32_t)1 << BIT_MODEL_BITS) {
		m->total = (m->total + 1) / 2;
		m->zeros = (m->zeros + 1) / 2;
		m->total += m->zeros == m->total;
	}
	uint32_t scale = 0x80000000u / m->total;
	m->probability = m->zeros * scale >> (31 - BIT_MODEL_BITS);
	m->cycle = m->cycle * 5 / 4;
	m->cycle = m->cycle < 64 ? m->cycle : 64;
	m->left = m->cycle;
}

/* ------------------------------------------------------------------------------ the interval */

static uint32_t next_byte(laz_coder *c)
{
	if (c->at < c->end)
		return *c->at++;
	c->over++;
	return 0;
}

void laz_coder_decode(laz_coder *c, const uint8_t *data, size_t length, laz_pool *pool)
{
	*c = (laz_coder){ .at = data, .end = data + length, .length = UINT32_MAX, .pool = pool };
	for (int b = 0; b < 4; b++)
		c->value = c->value << 8 | next_byte(c);
}

void laz_coder_encode(laz_coder *c, laz_pool *pool)
{
	*c = (laz_coder){
		.encodes = true, .length = UINT32_MAX, .bytes = c->bytes, .room = c->room, .pool = pool
	};
}

void laz_coder_clear(laz_coder *c)
{
	free(c->bytes);
	*c = (laz_coder){ 0 };
}

static void put_byte(laz_coder *c, uint8_t byte)
{
	if (c->used == c->room) {
		size_t room = c->room ? c->room + c->room / 2 : 1024;
		uint8_t *grown = realloc(c->bytes, room);
		if (!grown) {
			c->pool->failed = true;
			return;
		}
		c->bytes = grown;
		c->room = room;
	}
	c->bytes[c->used++] = byte;
}

/* Where the base overflows, the bytes that are out count one more. */
static void raise_base(laz_coder *c, uint32_t offset)
{
	c->value += offset;
	if (c->value < offset)
		for (size_t at = c->used; at > 0 && ++c->bytes[at - 1] == 0;)
			at--;
}

/* From the interval to a part of it. */
static inline void narrow(laz_coder *c, uint32_t low, uint32_t length)
{
	c->length = length;
	if (!c->encodes) {
		c->value -= low;
		for (; c->length < INTERVAL_MIN; c->length <<= 8)
			c->value = c->value << 8 | next_byte(c);
		return;
	}
	raise_base(c, low);
	for (; c->length < INTERVAL_MIN; c->length <<= 8) {
		put_byte(c, (uint8_t)(c->value >> 24));
		c->value <<= 8;
	}
}

/* One or two bytes say where in the interval; the others that a decoder takes in are zeros, so that
 * it takes none of what follows. */
void laz_coder_finish(laz_coder *c)
{
	bool wide = c->length > 2 * INTERVAL_MIN;
	if (wide)
		narrow(c, INTERVAL_MIN, INTERVAL_MIN >> 1);
	else
		narrow(c, INTERVAL_MIN >> 1, INTERVAL_MIN >> 9);
	for (int b = 0; b < (wide ? 3 : 2); b++)
		put_byte(c, 0);
}

/* --------------------------------------------------------------------------- symbols and bits */

/* The last symbol that begins at or before `target`. */
static uint32_t find_symbol(const laz_model *m, uint32_t target)
{
	uint32_t low = 0, high = m->symbols;
	if (m->table_bits) {
		uint32_t step = target >> (MODEL_BITS - m->table_bits);
		low = m->table[step];
		high = m->table[step + 1] + 1u;
	}
	while (high > low + 1) {
		uint32_t middle = (low + high) / 2;
		if (m->start[middle] > target)
			high = middle;
		else
			low = middle;
	}
	return low;
}

uint32_t laz_symbol(laz_coder *c, laz_model **model, uint32_t symbols, uint32_t symbol)
{
	laz_model *m = *model;
	if (!m && !(m = *model = make_model(c->pool, symbols, !c->encodes)))
		return 0;
	uint32_t whole = c->length, step = c->length >> MODEL_BITS;
	if (!c->encodes) {
		uint32_t target = c->value / step, most = ((uint32_t)1 << MODEL_BITS) - 1;
		symbol = find_symbol(m, target < most ? target : most);
	}
	assert(symbol < symbols);
	uint32_t low = m->start[symbol] * step;
	uint32_t high = symbol + 1 < m->symbols ? m->start[symbol + 1] * step : whole;
	narrow(c, low, high - low);
	m->count[symbol]++;
	if (--m->left == 0)
		update_model(m);
	return symbol;
}

uint32_t laz_bit(laz_coder *c, laz_bit_model *m, uint32_t bit)
{
	if (m->total == 0)
		*m = (laz_bit_model){ 1, 2, 1 << (BIT_MODEL_BITS - 1), 4, 4 };
	uint32_t middle = m->probability * (c->length >> BIT_MODEL_BITS);
	bool one = c->encodes ? bit : c->value >= middle;
	narrow(c, one ? middle : 0, one ? c->length - middle : middle);
	m->zeros += !one;
	if (--m->left == 0)
		update_bit_model(m);
	return one;
}

uint32_t laz_bits(laz_coder *c, uint32_t count, uint32_t bits)
{
	/* More would leave too short an interval: the low half comes first. */
	if (count > 19) {
		uint32_t low = laz_bits(c, 16, bits & 0xffff);
		return laz_bits(c, count - 16, bits >> 16) << 16 | low;
	}
	uint32_t step = c->length >> count;
	uint32_t value = c->encodes ? bits : c->value / step;
	narrow(c, value * step, step);
	c->failed = c->failed || value >> count != 0;
	return value & ((1u << count) - 1);
}

uint64_t laz_bits_64(laz_coder *c, uint64_t bits)
{
	uint64_t low = laz_bits(c, 32, (uint32_t)bits);
	return (uint64_t)laz_bits(c, 32, (uint32_t)(bits >> 32)) << 32 | low;
}

/* --------------------------------------------------------------------------------- integers */

/* A corrector of size k > 0 is in [1 - 2^k, -2^(k-1)] or [2^(k-1) + 1, 2^k], numbered from below;
 * one of size 0 is 0 or 1. */
static uint32_t size_of(int32_t corrector)
{
	uint32_t beyond = corrector > 0 ? (uint32_t)corrector - 1 : 0u - (uint32_t)corrector;
	return beyond ? 32 - (uint32_t)__builtin_clz(beyond) : 0;
}

static uint32_t code_corrector(laz_coder *c, laz_integer *integer, uint32_t size, int32_t corrector)
{
	if (size == 0)
		return laz_bit(c, &integer->small, (uint32_t)corrector);
	if (size >= 32)
		return 0x80000000u;
	uint32_t number = (uint32_t)corrector + (corrector > 0 ? 0 : 1u << size) - 1;
	uint32_t high = size < 8 ? size : 8, low = size - high;
	uint32_t highest = laz_symbol(c, &integer->high[size], 1u << high, number >> low);
	number = low ? highest << low | laz_bits(c, low, number & ((1u << low) - 1)) : highest;
	return number >= 1u << (size - 1) ? number + 1 : number - (1u << size) + 1;
}

/* The difference of two values that go round at 2^width, the nearer way. */
static int32_t nearer_way(uint32_t difference, uint32_t width)
{
	uint32_t range = 1u << (width & 31);
	if (width < 32)
		difference &= range - 1;
	return (int32_t)(width < 32 && difference >= range / 2 ? difference - range : difference);
}

int32_t laz_near(laz_coder *c, laz_integer *integer, laz_model **context, uint32_t width,
				 int32_t prediction, int32_t value)
{
	assert(width <= 32);
	int32_t corrector = 0;
	if (c->encodes)
		corrector = nearer_way((uint32_t)value - (uint32_t)prediction, width);
	integer->size = laz_symbol(c, context, width + 1, size_of(corrector));
	uint32_t sum = (uint32_t)prediction + code_corrector(c, integer, integer->size, corrector);
	if (width == 32)
		return (int32_t)sum;
	/* Values go round at 2^width. */
	return (int32_t)(sum & ((1u << width) - 1));
}
