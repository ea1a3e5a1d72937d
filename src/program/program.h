/* SPDX-License-Identifier: GPL-3.0-or-later */
/* program.h - what every program's main shares: complaints, the progress bar, signals, common options.
 * Linked into programs only: library code never prints and never sees a signal. */
#ifndef SG_PROGRAM_PROGRAM_H
#define SG_PROGRAM_PROGRAM_H

#include "core/progress.h"
#include "core/status.h"

#include <getopt.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/** Options that every program takes. */
typedef struct {
    uint64_t seed;
    int threads; /* 0: all cores */
    bool quiet;
    const char *json; /* NULL: none; "-" is standard output */
} sg_common_opts;

#define SG_COMMON_OPTS_INIT {1, 0, false, NULL}

/* Values of the long options that have no short form, above any character. Programs' own begin at SG_OPT_OWN. */
enum { SG_OPT_HELP = 1000, SG_OPT_VERSION, SG_OPT_SEED, SG_OPT_THREADS, SG_OPT_QUIET, SG_OPT_JSON, SG_OPT_OWN = 2000 };

#define SG_COMMON_LONG_OPTIONS                                                                                         \
    {"help", no_argument, NULL, SG_OPT_HELP}, {"version", no_argument, NULL, SG_OPT_VERSION},                          \
        {"seed", required_argument, NULL, SG_OPT_SEED}, {"threads", required_argument, NULL, SG_OPT_THREADS},          \
        {"quiet", no_argument, NULL, SG_OPT_QUIET}, {"json", required_argument, NULL, SG_OPT_JSON}

#define SG_COMMON_HELP                                                                                                 \
    "  --json FILE        write the machine-readable result; - is standard output\n"                                  \
    "  --seed N           seed of all random streams (default 1)\n"                                                    \
    "  --threads N        threads (default: all cores); the result does not depend on it\n"                            \
    "  --quiet            no progress\n"                                                                               \
    "  --help, --version\n"

/** Begin: name for messages, signal handlers (SIGINT and SIGTERM set a flag), GSL's aborting handler off. */
void sg_program_begin(const char *name);

typedef enum { SG_OPTION_TAKEN, SG_OPTION_OTHER, SG_OPTION_EXIT_OK, SG_OPTION_BAD } sg_option_result;
/** Handle one common option from getopt_long(); prints help or version when asked for (then EXIT_OK). */
sg_option_result sg_program_option(int opt, const char *arg, const char *help, sg_common_opts *opts);

/** Read all options with getopt_long(): the common ones here, the others by `take`, which complains and returns false when
 *  one makes no sense. optind is then the first argument that is no option.
 *  @return -1: go on; else the exit status to leave with (after --help, --version or wrong usage) */
int sg_program_options(int argc, char **argv, const char *short_options, const struct option *long_options,
                       const char *help, sg_common_opts *common, bool (*take)(int opt, const char *arg, void *user),
                       void *user);

/** Numbers from the command line; complain and return false when they are none or out of [low, high]. */
bool sg_program_size(const char *option, const char *arg, size_t low, size_t high, size_t *out);
bool sg_program_double(const char *option, const char *arg, double low, double high, double *out);
/** Index of arg in a NULL-terminated list; complains with the list and returns false when it is not in it. */
bool sg_program_choice(const char *option, const char *arg, const char *const *choices, int *out);
/** Several of them, with commas between: out has bit i for each choices[i]. */
bool sg_program_choices(const char *option, const char *arg, const char *const *choices, unsigned *out);

/** No run overwrites its input: SG_EINVAL when an output is the same file as one of n inputs (NULL: none). */
sg_status sg_program_spare(const char *output, const char *const *inputs, size_t n, sg_error *err);

/** No result overwrites another: SG_EINVAL when an output (NULL: none) would be the same file as one of n others. */
sg_status sg_program_apart(const char *output, const char *const *others, size_t n, sg_error *err);

/** "program: message" on standard error. */
void sg_program_complain(const char *format, ...) __attribute__((format(printf, 1, 2)));
/** Wrong usage: complain, point at --help, return 2. */
int sg_program_usage(const char *format, ...) __attribute__((format(printf, 1, 2)));
/** End: complain about err unless SG_OK, flush standard output (a full disk shows up here), return the exit status. */
int sg_program_end(sg_status status, const sg_error *err);

/** A progress bar with rate and time left when standard error is a terminal, a line now and then when it is not, nothing
 *  when quiet; stop() is true once SIGINT or SIGTERM came. */
sg_progress sg_program_progress(const sg_common_opts *opts);
/** Wipe the bar. */
void sg_program_progress_end(void);

#endif
