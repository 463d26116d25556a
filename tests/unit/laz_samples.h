/*
 * laz_samples.h - small LAS and LAZ files of points made up by a formula.
 *
 * The LAZ files are what LASzip 3.5 makes of these points, byte for byte: an implementation of
 * the format that is not ours. The LAS files are put together here, so that the formula is the only
 * truth about what a reader has to find.
 */
#ifndef LAZ_SAMPLES_H
#define LAZ_SAMPLES_H

#include <stddef.h>
#include <stdint.h>

enum { LAZ_SAMPLES = 5, LAZ_SAMPLE_POINTS = 30, LAZ_SAMPLE_BYTES = 4096 };

typedef struct laz_sample {
	const char *name; /* what it stands for */
	unsigned format;  /* of its points */
	unsigned extra;   /* bytes behind each point */
	const char *file; /* LAZ, in hexadecimal */
} laz_sample;

extern const laz_sample laz_samples[LAZ_SAMPLES];

/* Bytes of a point of a format. */
size_t laz_sample_record_bytes(unsigned format);

/* Writes point i: laz_sample_record_bytes(format) + extra bytes. */
void laz_sample_record(unsigned format, unsigned extra, unsigned i, uint8_t *record);

/* Writes the uncompressed twin, of LAZ_SAMPLE_POINTS points. Returns its length. */
size_t laz_sample_plain(unsigned format, unsigned extra, uint8_t file[LAZ_SAMPLE_BYTES]);

/* Writes a sample's LAZ file. Returns its length. */
size_t laz_sample_packed(const laz_sample *sample, uint8_t file[LAZ_SAMPLE_BYTES]);

#endif
