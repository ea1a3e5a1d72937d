/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_sizes.h - the part of bench_derivation about draws of sizes. */
#ifndef SG_EXPERIMENTS_BENCH_SIZES_H
#define SG_EXPERIMENTS_BENCH_SIZES_H

/** Print nanoseconds for each draw of 5, 10 and 20 sizes, beside the same by GSL's functions alone. */
void bench_sizes(double seconds);

#endif
