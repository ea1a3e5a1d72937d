/* SPDX-License-Identifier: GPL-3.0-or-later */
/* image.c - pictures and label maps in memory. */
#include "config.h"

#include "image/image.h"

#include <stdlib.h>

sg_status sg_image_check_size(size_t width, size_t height, sg_error *err)
{
    if (width == 0 || height == 0)
        return SG_FAIL(err, SG_EINVAL, "a picture of %zu x %zu pixels holds nothing", width, height);
    if (width > SG_IMAGE_MAX_SIDE || height > SG_IMAGE_MAX_SIDE)
        return SG_FAIL(err, SG_EINVAL, "%zu x %zu pixels are too many: a side may have %d", width, height,
                       SG_IMAGE_MAX_SIDE);
    if (width * height > SG_IMAGE_MAX_PIXELS)
        return SG_FAIL(err, SG_EINVAL, "%zu x %zu pixels are too many: a picture may have %u", width, height,
                       SG_IMAGE_MAX_PIXELS);
    return SG_OK;
}

sg_status sg_image_create(size_t width, size_t height, sg_image *out, sg_error *err)
{
    SG_TRY(sg_image_check_size(width, height, err));
    uint8_t *rgb = calloc(width * height, 3);
    if (rgb == NULL)
        return SG_FAIL_NOMEM(err);
    *out = (sg_image){width, height, rgb};
    return SG_OK;
}

sg_status sg_label_map_create(size_t width, size_t height, sg_label_map *out, sg_error *err)
{
    SG_TRY(sg_image_check_size(width, height, err));
    uint8_t *labels = calloc(width * height, 1);
    if (labels == NULL)
        return SG_FAIL_NOMEM(err);
    *out = (sg_label_map){width, height, labels};
    return SG_OK;
}

void sg_image_clear(sg_image *im)
{
    free(im->rgb);
    *im = (sg_image){0, 0, NULL};
}

void sg_label_map_clear(sg_label_map *m)
{
    free(m->labels);
    *m = (sg_label_map){0, 0, NULL};
}
