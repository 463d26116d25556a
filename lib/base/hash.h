/*
 * hash.h - 64 bits that stand for many bytes: two inputs that differ by accident have the same ones
 * with a chance of 2^-64. No protection against somebody who looks for such inputs.
 */
#ifndef HASH_H
#define HASH_H

#include <stddef.h>
#include <stdint.h>

/* The hash of `length` bytes, continued from `state`: that of another hash, or 0. The same on every
 * machine whose lowest byte comes first. */
uint64_t gw_hash(uint64_t state, const void *bytes, size_t length);

#endif
