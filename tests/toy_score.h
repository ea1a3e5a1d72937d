/* SPDX-License-Identifier: GPL-3.0-or-later */
/* toy_score.h - scores that are any function of a derivation, written down, computed from scratch each time.
 *
 * They are strict about score.h's protocol: that a proposal ends before the next begins, that the state stands where
 * the change begins, that what is proposed is a derivation, that nothing impossible is committed. And a test may
 * listen. */
#ifndef SG_TESTS_TOY_SCORE_H
#define SG_TESTS_TOY_SCORE_H

#include "score/score.h"

typedef double toy_function(const sg_derivation *d, void *user);

/** Hears of a proposal: the change, the derivation that it would make, what was asked and what was answered. */
typedef void toy_listener(void *user, const sg_change *change, const sg_derivation *proposed, double floor, double log);

typedef struct {
    sg_score base;
    toy_function *log_of; /* nats; -INFINITY: impossible */
    void *user;
    bool stops_early; /* -INFINITY for what is below the floor; else always exact */
    bool strict;      /* check each proposal thoroughly: slow */
    toy_listener *listener;
    void *listener_user;
} toy_score;

/** A target on the caller's stack; sg_score_free() does nothing to it. */
void toy_score_init(toy_score *s, toy_function *log_of, void *user);

/** A change made in a copy, without sg_derivation_apply(). */
void toy_apply(const sg_change *change, sg_derivation *out);

/** A log score for each derivation that looks drawn from N(0, scale^2): from its rules and the values of its draws.
 *  user: a toy_hash. Nothing about it is smooth or local. */
typedef struct {
    uint64_t seed;
    double scale;
    double impossible; /* share of derivations with -INFINITY */
} toy_hash;
double toy_hash_log(const sg_derivation *d, void *user);

#endif
