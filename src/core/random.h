/* SPDX-License-Identifier: GPL-3.0-or-later */
/* random.h - counter-based random streams behind GSL's interface.
 * A stream is a pure function of (seed, chain, iteration), so results do not depend on scheduling. Generator:
 * Philox 4x32-10 (Salmon, Moraes, Dror and Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC 2011) through Random123. */
#ifndef SG_CORE_RANDOM_H
#define SG_CORE_RANDOM_H

#include <gsl/gsl_rng.h>
#include <stddef.h>
#include <stdint.h>

/** The generator type, for gsl_rng_alloc(); gsl_rng_set(r, s) is sg_random_stream(r, s, 0, 0). */
extern const gsl_rng_type *const sg_random_philox;

/** A generator at the start of stream (seed, 0, 0), or NULL when memory is out; gsl_rng_free() ends it. */
gsl_rng *sg_random_create(uint64_t seed);

/** Put r at the start of the stream of (seed, chain, iteration). Streams with different keys are independent; each
 *  holds 2^34 32-bit draws. r must be of type sg_random_philox. */
void sg_random_stream(gsl_rng *r, uint64_t seed, uint32_t chain, uint64_t iteration);

/** A uniform in the open interval (0,1) with 52 random bits: never 0 or 1, so every inverse cdf takes it. */
double sg_random_uniform(gsl_rng *r);
/** The next n of them, in less time than by as many calls. */
void sg_random_uniforms(gsl_rng *r, double *u, size_t n);

#endif
