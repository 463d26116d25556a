/*
 * expected.h - what tests expect of calls: that they succeed, or that there is no device.
 *
 * A test that cannot run here is skipped. Whether that is allowed says the one switch
 * GLOWWORM_NO_SKIP, which tests/suite.sh and tests/cli/run look at; tests do not.
 */
#ifndef EXPECTED_H
#define EXPECTED_H

#include "device/gpu.h"

/* Skips the test when there is no Vulkan device; fails with the error's sentence after any other
 * failure. */
void assert_ok(gw_status status, const gw_error *error);

/* The same for calls under the validation layer, which is not everywhere either. */
void assert_ok_validated(gw_status status, const gw_error *error);

/* A device; the test is skipped when there is none that does what the options ask. */
gw_gpu *open_gpu(gw_gpu_options options);

#endif
