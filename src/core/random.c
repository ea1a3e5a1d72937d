/* SPDX-License-Identifier: GPL-3.0-or-later */
/* random.c - Philox 4x32-10 as a gsl_rng_type.
 * Key: the 64-bit seed. Counter: block number (32 bits), chain (32), iteration (64). */
#include "core/random.h"

#include <Random123/philox.h>

typedef struct {
    philox4x32_key_t key;
    philox4x32_ctr_t counter;
    philox4x32_ctr_t block; /* four words */
    philox4x32_ctr_t ahead; /* the four behind them, made while others work with these */
    unsigned next;          /* first unused word of block; 4 when none is left */
} philox_state;

static void next_block(philox_state *s)
{
    s->block = s->ahead;
    s->next = 0;
    s->ahead = philox4x32(s->counter, s->key);
    s->counter.v[0]++;
}

static unsigned long philox_get(void *vstate)
{
    philox_state *s = vstate;
    if (s->next == 4)
        next_block(s);
    return s->block.v[s->next++];
}

static double philox_get_double(void *vstate)
{
    return (double)philox_get(vstate) / 4294967296.0;
}

static void set_stream(philox_state *s, uint64_t seed, uint32_t chain, uint64_t iteration)
{
    s->key.v[0] = (uint32_t)seed;
    s->key.v[1] = (uint32_t)(seed >> 32);
    s->counter.v[0] = 0;
    s->counter.v[1] = chain;
    s->counter.v[2] = (uint32_t)iteration;
    s->counter.v[3] = (uint32_t)(iteration >> 32);
    s->ahead = philox4x32(s->counter, s->key);
    s->counter.v[0] = 1;
    s->next = 4;
}

static void philox_set(void *vstate, unsigned long seed)
{
    set_stream(vstate, seed, 0, 0);
}

static const gsl_rng_type philox_type = {
    "philox4x32-10", 0xffffffffUL, 0, sizeof(philox_state), philox_set, philox_get, philox_get_double,
};

const gsl_rng_type *const sg_random_philox = &philox_type;

gsl_rng *sg_random_create(uint64_t seed)
{
    gsl_rng *r = gsl_rng_alloc(sg_random_philox);
    if (r != NULL)
        sg_random_stream(r, seed, 0, 0);
    return r;
}

void sg_random_stream(gsl_rng *r, uint64_t seed, uint32_t chain, uint64_t iteration)
{
    set_stream(r->state, seed, chain, iteration);
}

static inline double uniform_of(uint64_t high, uint64_t low)
{
    const uint64_t bits = (high << 20) | (low >> 12); /* 52 bits */
    return ((double)bits + 0.5) * 0x1p-52;
}

/* Without the calls, as long as two words of a block are left. */
static inline double next_uniform(gsl_rng *r)
{
    philox_state *s = r->state;
    if (r->type != sg_random_philox || s->next % 2 != 0) {
        const uint64_t high = gsl_rng_get(r), low = gsl_rng_get(r);
        return uniform_of(high, low);
    }
    if (s->next == 4)
        next_block(s);
    const uint32_t *words = s->block.v + s->next;
    s->next += 2;
    return uniform_of(words[0], words[1]);
}

double sg_random_uniform(gsl_rng *r)
{
    return next_uniform(r);
}

void sg_random_uniforms(gsl_rng *r, double *u, size_t n)
{
    for (size_t i = 0; i < n; i++)
        u[i] = next_uniform(r);
}
