#include "lamps/light_preset.h"

#include <string.h>

/* Flames are points that shine alike to all sides; who wants soft shadows gives a radius. What they
 * were measured in are candles: one international candle is 1/1.02 cd.
 *
 * What kind of sources these are: candle and carbide rest on handbooks of the years around 1905;
 * that half of the gas is the burner's share is worked out, not measured on a lamp. The torch is an
 * experiment of 2021, five torches of ivy, juniper, oak, birch and pine resin against lamps that
 * burn marrow, of which the ratio is published; its absolute figure is that ratio times two
 * fat-lamps. The fat-lamp is said to be like a candle, by authors who do not say how they measured.
 * The headlamp is a standard. Whatever was not measured on such a lamp is called an estimate
 * wherever people read of it. */
const light_preset light_presets[] = {
	{ "candle", GW_LIGHT_POINT, "intensity 1.2cd kelvin 1930", 0, "a candle of wax or paraffin",
	  NULL,
	  "1.145 to 1.298 candles, whatever its size (F. H. Leeds, W. J. A. Butterfield, Acetylene, "
	  "2nd edition, chapter 1); 1,930 K (The Physics Factbook, Temperature of a Candle Flame)" },
	{ "fat-lamp", GW_LIGHT_POINT, "intensity 1.2cd kelvin 1930", 0,
	  "a stone lamp that burns animal fat with one wick", "what a candle gives",
	  "about as much as a candle (S. A. de Beaune, R. White, Ice Age Lamps, Scientific American "
	  "266(3), 1993); colour as of a candle, whose light comes from soot too" },
	{ "torch", GW_LIGHT_POINT, "intensity 12cd kelvin 1930", 0, "a burning torch of several sticks",
	  "a measured ratio to fat lamps, times what these are estimated to give",
	  "almost five times a fat lamp with two wicks (M. A. Medina-Alcaide and others, The Conquest "
	  "of the Dark Spaces, PLoS ONE 16(6), 2021), each wick taken for a fat-lamp; colour "
	  "likewise" },
	{ "carbide", GW_LIGHT_POINT, "intensity 24cd kelvin 2360", 0,
	  "flame of a carbide lamp, 14 l an hour, at best",
	  "the light that a cubic foot of acetylene was measured to give, times what it burns",
	  "at most 48 candles for a cubic foot an hour (Leeds and Butterfield, chapter 8), of which "
	  "the burner takes half; 2,360 K (E. P. Hyde, W. E. Forsythe, F. E. Cady, Note on the "
	  "Distribution of Energy in the Visible Spectrum of a Cylindrical Acetylene Flame)" },
	{ "headlamp", GW_LIGHT_SPOT, "", 1u << LIGHT_KEY_LUMENS | 1u << LIGHT_KEY_DISTANCE,
	  "a headlamp by the lumens and beam distance on its box", NULL,
	  "ANSI/PLATO FL 1: light output, and the distance at which the middle of the beam gives 0.25 "
	  "lx; its cone is as wide as both say" },
	{ .name = NULL },
};

const light_preset *light_preset_find(const char *name)
{
	for (const light_preset *p = light_presets; p->name; p++)
		if (strcmp(p->name, name) == 0)
			return p;
	return NULL;
}
