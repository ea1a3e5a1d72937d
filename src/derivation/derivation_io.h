/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_io.h - derivations as binary files (*.sgd), bit for bit: nodes, uniforms, values, open nodes included. */
#ifndef SG_DERIVATION_DERIVATION_IO_H
#define SG_DERIVATION_DERIVATION_IO_H

#include "core/bytes.h"
#include "derivation/derivation.h"

/** What a file holds: a zeroed one is empty, free with sg_derivation_file_clear(). */
typedef struct {
    sg_derivation *items; /* [n] of one grammar, none without a node */
    double *log_priors;   /* [n] sg_derivation_log_prior() */
    size_t n, items_capacity, log_priors_capacity;
} sg_derivation_file;

void sg_derivation_file_clear(sg_derivation_file *f);
/** Room for one more, which is made an empty derivation of g and counts already. @return SG_OK, SG_ENOMEM */
sg_status sg_derivation_file_add(sg_derivation_file *f, const sg_grammar *g, sg_error *err);
/** Look whether the last one is good, and note its log prior.
 *  @return SG_OK, SG_EINPUT (sg_derivation_check() fails, or a weight is impossible; the sentence names the node), SG_ENOMEM */
sg_status sg_derivation_file_check_last(sg_derivation_file *f, sg_error *err);

/** Append the bytes of a file with n derivations of g to out.
 *  @return SG_OK, SG_EINVAL (one is empty or of another grammar), SG_ENUMERIC (one has no log prior), SG_ENOMEM */
sg_status sg_derivation_file_encode(const sg_grammar *g, const sg_derivation *list, size_t n, sg_bytes *out, sg_error *err);
/** The same as a file. @return as above, SG_EIO */
sg_status sg_derivation_file_write(const char *path, const sg_grammar *g, const sg_derivation *list, size_t n,
                                   sg_error *err);

/** Derivations of g from bytes; name stands for the file in messages, which tell the offset of what is wrong. Nothing is
 *  believed: sizes are compared with what is there, and each derivation passes sg_derivation_check().
 *  @return SG_OK, SG_EINPUT (no such file, cut, damaged, of another version or grammar), SG_ENOMEM; out only on success */
sg_status sg_derivation_file_decode(const unsigned char *bytes, size_t n, const char *name, const sg_grammar *g,
                                    sg_derivation_file *out, sg_error *err);
/** The same from a file; "-" is standard input. */
sg_status sg_derivation_file_read(const char *path, const sg_grammar *g, sg_derivation_file *out, sg_error *err);

#endif
