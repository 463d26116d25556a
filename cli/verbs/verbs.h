/*
 * verbs.h - what the program does, one function a verb. Each prints what it has to, and returns how
 * it went; the caller prints the error.
 */
#ifndef VERBS_H
#define VERBS_H

#include "options/settings.h"

/* Bytes that a point adds at least to a transport: its surfel, as the transport's blocks have it.
 */
#define TRANSPORT_BYTES 100u

/* Reads, lights, writes. Changes the settings: reads scene files into them. */
gw_status verb_bake(settings *settings, gw_error *error);

/* Says what a bake would compute, why, and what it would take. Changes the settings likewise. */
gw_status verb_plan(settings *settings, gw_error *error);

/* Samples points on a mesh and writes them. */
gw_status verb_sample(const settings *settings, gw_error *error);

/* Prints what is in files, or lists the devices, to standard output. */
gw_status verb_info(const settings *settings, gw_error *error);

/* Prints how far one lit cloud is from another. STATUS_MISSED when a limit is exceeded. */
gw_status verb_compare(const settings *settings, gw_error *error);

/* Bakes a scene at many settings and prints what each costs and how far it is from the finest one.
 * Changes the settings as verb_bake does. STATUS_MISSED when none is as good as asked. */
gw_status verb_tradeoff(settings *settings, gw_error *error);

/* Looks at everything that a bake needs and prints what it found. GW_ERROR_NO_DEVICE when no device
 * can bake, STATUS_MISSED when something else is not good. */
gw_status verb_doctor(const settings *settings, gw_error *error);

/* Prints how a luminaire shines, and draws it. */
gw_status verb_lamp(const settings *settings, gw_error *error);

/* Makes lamps of a lit cloud stronger or weaker without baking, and writes it. */
gw_status verb_mix(const settings *settings, gw_error *error);
/* Takes the light out of photographed colours. Changes the settings as verb_bake does. */
gw_status verb_albedo(settings *settings, gw_error *error);

/* Prints how much light there is on a piece of a lit cloud, and of which lamp. */
gw_status verb_measure(const settings *settings, gw_error *error);

/* Lights a scene, places probes in it and writes what they see. Changes the settings as verb_bake
 * does. */
gw_status verb_probes(settings *settings, gw_error *error);

/* Prints the ways in which light between surfaces is gathered. */
gw_status verb_methods(const settings *settings, gw_error *error);
gw_status verb_page(const settings *settings, gw_error *error);

/* Reads one file and writes another. */
gw_status verb_convert(const settings *settings, gw_error *error);
/* Makes pictures of a cloud. Changes the settings as verb_bake does. */
gw_status verb_render(settings *settings, gw_error *error);

#endif
