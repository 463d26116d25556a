/*
 * error.c - failures as sentences, words that fit numbers, the version, and the names of the
 * public enums.
 */
#include "glowworm.h"
#include "glowworm_host.h"

#include <assert.h>
#include <stdarg.h>
#include <stdio.h>

#undef gw_fail
gw_status gw_fail(gw_error *error, gw_status status, const char *format, ...)
{
	if (error != NULL) {
		va_list arguments;
		va_start(arguments, format);
		vsnprintf(error->text, sizeof error->text, format, arguments);
		va_end(arguments);
		error->status = status;
	}
	return status;
}

const char *gw_version(void)
{
	return GW_VERSION;
}

const char *gw_method_name(gw_method method)
{
	static const char *const name[] = {
		[GW_METHOD_RAYS] = "rays", [GW_METHOD_CONES] = "cones",   [GW_METHOD_VOLUME] = "volume",
		[GW_METHOD_LPV] = "lpv",   [GW_METHOD_PROBES] = "probes", [GW_METHOD_BUFFERS] = "buffers"
	};
	static_assert(sizeof name / sizeof *name == GW_METHOD_COUNT, "every method has a name");
	assert((unsigned)method < GW_METHOD_COUNT);
	return name[method];
}

const char *gw_basis_name(gw_basis basis)
{
	static const char *const name[] = { [GW_BASIS_AUTO] = "auto",
										[GW_BASIS_SCALAR] = "scalar",
										[GW_BASIS_DIRECTIONAL] = "directional" };
	static_assert(sizeof name / sizeof *name == GW_BASIS_COUNT, "every basis has a name");
	assert((unsigned)basis < GW_BASIS_COUNT);
	return name[basis];
}

const char *gw_shadows_name(gw_shadows shadows)
{
	static const char *const name[] = {
		[GW_SHADOWS_TRACED] = "traced", [GW_SHADOWS_MAPS] = "maps", [GW_SHADOWS_NONE] = "none"
	};
	static_assert(sizeof name / sizeof *name == GW_SHADOWS_COUNT, "every kind has a name");
	assert((unsigned)shadows < GW_SHADOWS_COUNT);
	return name[shadows];
}

const char *gw_pass_choice_name(gw_pass_choice choice)
{
	static const char *const name[] = {
		[GW_PASSES_AUTO] = "auto", [GW_PASSES_DEVICE] = "device", [GW_PASSES_CPU] = "cpu"
	};
	static_assert(sizeof name / sizeof *name == GW_PASSES_COUNT, "every choice has a name");
	assert((unsigned)choice < GW_PASSES_COUNT);
	return name[choice];
}

const char *gw_validation_name(gw_validation validation)
{
	static const char *const name[] = { [GW_VALIDATE_NOTHING] = "none",
										[GW_VALIDATE_CALLS] = "calls",
										[GW_VALIDATE_ACCESSES] = "accesses" };
	static_assert(sizeof name / sizeof *name == GW_VALIDATION_COUNT, "every kind has a name");
	assert((unsigned)validation < GW_VALIDATION_COUNT);
	return name[validation];
}

const char *gw_stray_kind_name(gw_stray_kind kind)
{
	static const char *const name[GW_STRAY_KIND_COUNT] = {
		[GW_STRAY_NOISE] = "noise",     [GW_STRAY_WITHHELD] = "withheld",
		[GW_STRAY_ZERO] = "zero point", [GW_STRAY_NO_DATA] = "no data",
		[GW_STRAY_FAR] = "far off",     [GW_STRAY_ALONE] = "alone",
		[GW_STRAY_MIXED] = "mixed",     [GW_STRAY_HAZE] = "haze",
		[GW_STRAY_MOUNT] = "mount",
	};
	return kind < GW_STRAY_KIND_COUNT ? name[kind] : "unknown";
}

const char *gw_gaps_name(gw_gaps gaps)
{
	static const char *const name[] = {
		[GW_GAPS_OPEN] = "open", [GW_GAPS_BLACK] = "black", [GW_GAPS_MEAN] = "mean"
	};
	static_assert(sizeof name / sizeof *name == GW_GAPS_COUNT, "every choice has a name");
	assert((unsigned)gaps < GW_GAPS_COUNT);
	return name[gaps];
}

const char *gw_effect_name(gw_effect_kind effect)
{
	static const char *const name[] = {
		[GW_EFFECT_LAMPS] = "lamps",       [GW_EFFECT_SHADOWS] = "shadows",
		[GW_EFFECT_EMITTERS] = "emitters", [GW_EFFECT_SKY] = "sky",
		[GW_EFFECT_PORTALS] = "portals",   [GW_EFFECT_BOUNCES] = "bounces",
		[GW_EFFECT_GAPS] = "gaps",         [GW_EFFECT_ERROR] = "error",
		[GW_EFFECT_OCTREE] = "octree",     [GW_EFFECT_TRANSMISSION] = "transmission",
		[GW_EFFECT_NORMALS] = "normals",   [GW_EFFECT_NOISE] = "noise",
		[GW_EFFECT_COLUMNS] = "columns",
	};
	static_assert(sizeof name / sizeof *name == GW_EFFECT_KIND_COUNT, "every effect has a name");
	assert((unsigned)effect < GW_EFFECT_KIND_COUNT);
	return name[effect];
}

const char *gw_goal_name(gw_goal goal)
{
	static const char *const name[] = { [GW_GOAL_NONE] = "none",
										[GW_GOAL_REACHED] = "reached",
										[GW_GOAL_TIME] = "time",
										[GW_GOAL_EXHAUSTED] = "exhausted",
										[GW_GOAL_STALLED] = "stalled",
										[GW_GOAL_MEMORY] = "memory",
										[GW_GOAL_OUT_OF_REACH] = "out of reach" };
	static_assert(sizeof name / sizeof *name == GW_GOAL_COUNT, "every goal has a name");
	assert((unsigned)goal < GW_GOAL_COUNT);
	return name[goal];
}

const char *gw_light_type_name(gw_light_type type)
{
	static const char *const name[] = { [GW_LIGHT_POINT] = "point",
										[GW_LIGHT_SPOT] = "spot",
										[GW_LIGHT_SUN] = "sun",
										[GW_LIGHT_ENVIRONMENT] = "environment",
										[GW_LIGHT_SPHERE] = "sphere",
										[GW_LIGHT_DISC] = "disc",
										[GW_LIGHT_RECTANGLE] = "rectangle" };
	static_assert(sizeof name / sizeof *name == GW_LIGHT_TYPE_COUNT, "every type has a name");
	assert((unsigned)type < GW_LIGHT_TYPE_COUNT);
	return name[type];
}

const char *gw_plural(uint64_t number, const char *one, const char *many)
{
	return number == 1 ? one : many;
}
