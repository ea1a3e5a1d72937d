/* SPDX-License-Identifier: GPL-3.0-or-later */
/* png_make.h - PNG files of any format for tests, straight through libpng. */
#ifndef SG_TESTS_PNG_MAKE_H
#define SG_TESTS_PNG_MAKE_H

#include <check.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>

/** Write packed rows as they are: bits and type are libpng's; a palette of 256 shades of grey is given where needed. */
static inline void png_make(const char *path, unsigned width, unsigned height, int bits, int type, int interlace,
                            const unsigned char *rows, size_t stride)
{
    FILE *fp = fopen(path, "wb");
    ck_assert_ptr_nonnull(fp);
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, fp);
    png_set_IHDR(png, info, width, height, bits, type, interlace, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_color palette[256];
    for (int i = 0; i < 256; i++)
        palette[i] = (png_color){(png_byte)i, (png_byte)(255 - i), 7};
    if (type == PNG_COLOR_TYPE_PALETTE)
        png_set_PLTE(png, info, palette, 1 << bits);
    png_write_info(png, info);
    const int passes = png_set_interlace_handling(png);
    for (int pass = 0; pass < passes; pass++)
        for (unsigned y = 0; y < height; y++)
            png_write_row(png, rows + y * stride);
    png_write_end(png, NULL);
    png_destroy_write_struct(&png, &info);
    ck_assert_int_eq(fclose(fp), 0);
}

#endif
