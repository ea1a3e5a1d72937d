/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sample_sheet.c - the first samples on one page. */
#include "config.h"

#include "sample_job.h"

#include "image/png_io.h"
#include "scene/contact_sheet.h"

#include <math.h>

enum { SHEET_SIDE_PX = 4096 };

/* Pictures on the sheet are as large as the others, unless the sheet would become too large to look at. */
void sample_plan_sheet(sample_job *j)
{
    const sample_options *o = j->opts;
    if (!(o->formats & SAMPLE_SHEET))
        return;
    j->nthumbs = o->columns * o->rows < j->n ? o->columns * o->rows : j->n;
    const double scale = fmin(1, fmin((double)SHEET_SIDE_PX / (double)(o->columns * o->width),
                                      (double)SHEET_SIDE_PX / (double)(o->rows * o->height)));
    j->thumb_width = (size_t)fmax(1, scale * (double)o->width);
    j->thumb_height = (size_t)fmax(1, scale * (double)o->height);
}

sg_status sample_write_sheet(sample_job *j, sg_error *err)
{
    size_t n = 0;
    for (size_t i = 0; i < j->nthumbs; i++) { /* after an interrupt some may be missing */
        const sg_image im = j->thumbs[i];
        j->thumbs[i] = (sg_image){0};
        if (im.rgb != NULL)
            j->thumbs[n++] = im;
    }
    if (n == 0)
        return SG_OK;
    char path[4096];
    sg_image sheet;
    sg_sheet_opts o = SG_SHEET_OPTS_INIT;
    o.columns = j->opts->columns < n ? j->opts->columns : n;
    if (snprintf(path, sizeof path, "%s/sheet.png", j->opts->folder) >= (int)sizeof path)
        return SG_FAIL(err, SG_EIO, "%s: the path is too long", j->opts->folder);
    SG_TRY(sample_check_not_input(j, path, err));
    SG_TRY(sg_contact_sheet(j->thumbs, n, &o, &sheet, err));
    const sg_status st = sg_png_write_rgb(path, &sheet, err);
    sg_image_clear(&sheet);
    return st;
}

