/*
 * laz_coder.h - the arithmetic coder of LAZ: from bytes to symbols, bits and integers, and back.
 *
 * The coder is Amir Said's (Introduction to Arithmetic Coding, HPL-2004-76) with adaptive models of
 * 2^15 and bits of 2^13 steps. Integers are coded as a prediction and a corrector: first how many
 * bits the corrector has, then, from a model for that number, its highest eight, then the rest
 * unmodelled.
 *
 * Decoding and encoding go the same way, so that the statistics of both cannot come apart: a
 * function takes what the next value is to be, which only counts when encoding, and returns what it
 * is.
 *
 * Models are made when they are first used, in a pool that is emptied for each chunk: pointers to
 * them start as NULL, so that zeroed memory is a coder's state at the start of a chunk.
 *
 * Damaged data gives wrong values but never reads outside of its bytes; laz_coder.failed and
 * .over say so afterwards. Thread-safety: calls on different coders with different pools.
 */
#ifndef LAZ_CODER_H
#define LAZ_CODER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Memory for models. Zeroed: empty. */
typedef struct laz_pool {
	struct laz_block *first, *current; /* owned list */
	bool failed;                       /* memory was short */
} laz_pool;

void laz_pool_clear(laz_pool *pool);

/* Takes all models back; the memory stays for the next ones. */
void laz_pool_reset(laz_pool *pool);

/* Frequencies of the symbols of an alphabet. */
typedef struct laz_model laz_model;

/* The frequency of a bit. Zeroed: not used yet. */
typedef struct laz_bit_model {
	uint32_t zeros, total;
	uint32_t probability; /* of a zero, in 2^-13 */
	uint32_t cycle, left; /* bits between updates, and until the next one */
} laz_bit_model;

typedef struct laz_coder {
	uint32_t length; /* of the interval */
	uint32_t value;  /* decoding: where in the interval, below length; encoding: its base */
	bool encodes;
	const uint8_t *at, *end; /* decoding: what was not taken in yet; NULL: no data */
	size_t over;             /* bytes that were wanted beyond the end and taken as zero */
	bool failed;             /* what came out is impossible */
	uint8_t *bytes;          /* encoding, owned: what was put out */
	size_t used, room;       /* of them */
	bool changed;            /* a value was another than the one before it, says who encodes it */
	laz_pool *pool;
} laz_coder;

/* Starts on bytes; they are the caller's. */
void laz_coder_decode(laz_coder *c, const uint8_t *data, size_t length, laz_pool *pool);

/* Starts without any, in memory that stays from one start to the next. c: zeroed before the first
 * start; pool->failed when memory gets short. */
void laz_coder_encode(laz_coder *c, laz_pool *pool);

/* Puts out the last bytes. */
void laz_coder_finish(laz_coder *c);

/* Gives back what encoding took. */
void laz_coder_clear(laz_coder *c);

/* True where there are values: always when encoding, and when decoding if there is data. */
static inline bool laz_coder_has_values(const laz_coder *c)
{
	return c->encodes || c->at;
}

/* The next symbol of an alphabet.
 *   model     where its model is or will be
 *   symbols   2 to 1024, always the same for one model
 *   symbol    below symbols, when encoding */
uint32_t laz_symbol(laz_coder *c, laz_model **model, uint32_t symbols, uint32_t symbol);

uint32_t laz_bit(laz_coder *c, laz_bit_model *model, uint32_t bit);

/* Unmodelled bits, 1 to 32 of them, and 64. */
uint32_t laz_bits(laz_coder *c, uint32_t count, uint32_t bits);
uint64_t laz_bits_64(laz_coder *c, uint64_t bits);

/* Models of the correctors of a kind of integer. Zeroed: not used yet. */
typedef struct laz_integer {
	uint32_t size; /* of the last corrector in bits: a context for other values */
	laz_bit_model small;
	laz_model *high[33];
} laz_integer;

/*
 * The next integer near a prediction.
 *   context   model of the corrector's size, one a context
 *   width     8, 16 or 32 bits. Those of 8 and 16 are returned without sign
 *   value     with or without sign, when encoding
 */
int32_t laz_near(laz_coder *c, laz_integer *integer, laz_model **context, uint32_t width,
				 int32_t prediction, int32_t value);

/* The next byte near a prediction, modelled by the difference. */
static inline uint8_t laz_byte_near(laz_coder *c, laz_model **model, int prediction, uint8_t value)
{
	return (uint8_t)(prediction + (int)laz_symbol(c, model, 256, (uint8_t)(value - prediction)));
}

#endif
