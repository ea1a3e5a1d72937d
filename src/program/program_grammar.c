/* SPDX-License-Identifier: GPL-3.0-or-later */
/* program_grammar.c - reads a grammar and passes its warnings on. */
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
