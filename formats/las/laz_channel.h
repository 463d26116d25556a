/*
 * laz_channel.h - the base of points of formats 6 to 10 in layered LAZ: coordinates, returns,
 * classification, flags, intensity, angle, user data, source and time, each in a layer of its own.
 */
#ifndef LAZ_CHANNEL_H
#define LAZ_CHANNEL_H

#include "las/laz_values.h"

enum { LAZ_CHANNELS = 4, LAZ_POINT14_BYTES = 30 };

typedef enum laz_layer {
	LAZ_LAYER_PLACE, /* scanner channel, returns, x and y; what changed of the others */
	LAZ_LAYER_Z,
	LAZ_LAYER_CLASS,
	LAZ_LAYER_FLAGS,
	LAZ_LAYER_INTENSITY,
	LAZ_LAYER_ANGLE,
	LAZ_LAYER_USER,
	LAZ_LAYER_SOURCE,
	LAZ_LAYER_TIME,
	LAZ_LAYER_COUNT
} laz_layer;

/* A point, unpacked. */
typedef struct laz_point {
	int32_t x, y, z;
	uint16_t intensity, source;
	uint8_t number, returns; /* return number, number of returns */
	uint8_t flags;           /* classification flags, bit 4 scan direction, bit 5 edge */
	uint8_t classification, user, channel;
	int16_t angle;
	uint64_t time; /* bits of a double */
} laz_point;

/* The last point of a scanner channel and the statistics of what followed. */
typedef struct laz_channel {
	bool started;
	laz_point last;
	bool new_time; /* it had another time than the one before it */

	laz_model *changed[8], *other_channel, *returns_after[16], *number_after[16], *number_step;
	laz_median x_median[12], y_median[12];
	laz_integer dx, dy, height, intensities, angles, sources;
	laz_model *dx_context[2], *dy_context[22], *height_context[20];
	int32_t last_z[8];
	laz_model *classes[64], *flag_sets[64], *users[64];
	uint16_t last_intensity[8];
	laz_model *intensity_context[4], *angle_context[2], *source_context;
	laz_time time;
} laz_channel;

/* Starts a channel from a point in LAS's bytes. channel: zeroed */
void laz_channel_start(laz_channel *channel, const uint8_t *point);

/*
 * Codes a point of the channel that it belongs to.
 *   channel   all four
 *   current   number of the channel of the point before; becomes that of this one
 *   layer     coders; the values of one without values stay as they are
 *   point     LAZ_POINT14_BYTES: what it is to be when encoding, and receives what it is
 */
void laz_channel_next(laz_channel channel[LAZ_CHANNELS], uint32_t *current, laz_coder *layer,
					  uint8_t *point);

#endif
