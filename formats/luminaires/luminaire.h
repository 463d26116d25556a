/*
 * luminaire.h - how a luminaire shines, as its maker measured it: IES LM-63 and EULUMDAT files.
 *
 * Angles are those of the C planes (CIE 121, type C of LM-63): gamma from straight down of a
 * luminaire that hangs, and C around that. Of photometry of type B or A, whose axis is level, gamma
 * is the angle from the middle of the beam, C 0 is to the right of who looks along it, C 90 up.
 */
#ifndef LUMINAIRE_H
#define LUMINAIRE_H

#include "files/input_file.h"

#define LUMINAIRE_TEXT 160

/* Tilts of which a file tells the light. */
#define LUMINAIRE_TILTS 64

typedef struct luminaire {
	float *distribution; /* owned; as gw_light.distribution, the largest share is 1 */
	uint32_t verticals, horizontals;
	double candela;       /* at the share of 1: luminous intensity, cd */
	double lamp_lumens;   /* of its lamps, by themselves; 0: only what leaves the luminaire was
							 measured */
	double stated_lumens; /* that leave the luminaire, as the file says; 0: it does not */
	double watts;         /* 0: not said */
	double
		size[3]; /* of what glows, metres: along C 0, along C 90, height; 0 where it is a point */
	bool round;  /* it is a disc or cylinder, of these diameters */
	char photometry;             /* 'C', or 'B' or 'A', of which this was worked out */
	char format[LUMINAIRE_TEXT]; /* "IES LM-63-2002" */
	char maker[LUMINAIRE_TEXT], model[LUMINAIRE_TEXT], lamp[LUMINAIRE_TEXT]; /* UTF-8, or "" */

	size_t
		tilts; /* by how much of its light is left when it is tilted from hanging; 0: by nothing */
	double tilt[LUMINAIRE_TILTS], tilt_factor[LUMINAIRE_TILTS]; /* degrees, ascending; factors */
} luminaire;

/* What its distribution comes to. */
typedef struct luminaire_facts {
	double lumens;   /* over all directions */
	double downward; /* share of these below the horizon of one that hangs */
	double beam[2];  /* degrees between the outermost directions of at least half the largest
						intensity, in the planes C 0 and 180, and C 90 and 270 */
	double field[2]; /* the same of a tenth */
	double peak_gamma, peak_c; /* degrees: where it is largest */
} luminaire_facts;

/* Frees what it owns and empties it. */
void luminaire_clear(luminaire *l);

/* Flux over all directions, lumens: exact for what is linear between the angles. */
double luminaire_lumens(const luminaire *l);

/* All that is worked out from the distribution. */
luminaire_facts luminaire_measure(const luminaire *l);

/* Intensity, cd, between the angles in degrees; C of any sign. */
double luminaire_intensity(const luminaire *l, double gamma, double c);

/* How much of its light is left at so many degrees from hanging. */
double luminaire_tilt_factor(const luminaire *l, double degrees);

/* Read the one format and the other, from bytes; luminaire_reader.h finds out which it is.
 *   l          on success the caller's, freed with luminaire_clear; empty on failure
 *   error      GW_ERROR_DATA with a sentence that names the file and the line; GW_ERROR_MEMORY */
gw_status luminaire_ies_read(const input_file *in, luminaire *l, gw_error *error);
gw_status luminaire_eulumdat_read(const input_file *in, luminaire *l, gw_error *error);

#endif
