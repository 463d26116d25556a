/*
 * laz_coder.h - the arithmetic decoder of LAZ: from bytes to symbols, bits and integers.
 *
 * The coder is Amir Said's (Introduction to Arithmetic Coding, HPL-2004-76) with adaptive models of
 * 2^15 and bits of 2^13 steps. Integers are coded as a prediction and a corrector: first how many
 * bits the corrector has, then, from a model for that number, its highest eight, then the rest
 * unmodelled.
 *
 * Models are made when they are first used, in a pool that is emptied for each chunk: pointers to
 * them start as NULL, so that zeroed memory is a decoder's state at the start of a chunk.
 *
 * Damaged data gives wrong values but never reads outside of its bytes; laz_decoder.failed and
 * .over say so afterwards. Thread-safety: calls on different decoders with different pools.
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

typedef struct laz_decoder {
	const uint8_t *at, *end;
	uint32_t value, length; /* of the interval; value < length */
	size_t over;            /* bytes that were wanted beyond the end and taken as zero */
	bool failed;            /* what came out is impossible */
	laz_pool *pool;
} laz_decoder;

/* Starts on bytes; they are the caller's. */
void laz_decoder_start(laz_decoder *d, const uint8_t *data, size_t length, laz_pool *pool);

/* The next symbol of an alphabet.
 *   model     where its model is or will be
 *   symbols   2 to 1024, always the same for one model */
uint32_t laz_symbol(laz_decoder *d, laz_model **model, uint32_t symbols);

uint32_t laz_bit(laz_decoder *d, laz_bit_model *model);

/* Unmodelled bits, 1 to 32 of them, and 64. */
uint32_t laz_bits(laz_decoder *d, uint32_t count);
uint64_t laz_bits_64(laz_decoder *d);

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
 */
int32_t laz_near(laz_decoder *d, laz_integer *integer, laz_model **context, uint32_t width,
				 int32_t prediction);

#endif
