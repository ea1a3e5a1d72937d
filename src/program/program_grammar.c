/* SPDX-License-Identifier: GPL-3.0-or-later */
/* program_grammar.c - reads a grammar and passes its warnings on; its files are not written over. */
#include "config.h"

#include "program/program_grammar.h"

#include "program/program.h"

sg_status sg_program_load_grammar(const char *path, sg_grammar **out, sg_error *err)
{
    SG_TRY(sg_grammar_load(path, out, err));
    for (size_t i = 0; i < sg_grammar_warning_count(*out); i++)
        sg_program_complain("%s", sg_grammar_warning(*out, i));
    return SG_OK;
}

sg_status sg_program_spare_grammar(const char *output, const char *path, const sg_grammar *g, sg_error *err)
{
    SG_TRY(sg_program_spare(output, &path, 1, err));
    for (size_t i = 0; i < sg_grammar_import_count(g); i++) {
        const char *imported = sg_grammar_import(g, i);
        SG_TRY(sg_program_spare(output, &imported, 1, err));
    }
    return SG_OK;
}
