/* SPDX-License-Identifier: GPL-3.0-or-later */
/* check_png.c - for the shell tests: prints the sizes of PNG files all of whose pixels can be read, WIDTHxHEIGHT NAME. */
#include "image/png_io.h"

#include <stdio.h>

int main(int argc, char **argv)
{
    for (int i = 1; i < argc; i++) {
        sg_error err = {0};
        sg_image im = {0};
        if (sg_png_read_rgb(argv[i], &im, &err) != SG_OK) {
            fprintf(stderr, "%s\n", err.msg);
            return 1;
        }
        printf("%zux%zu %s\n", im.width, im.height, argv[i]);
        sg_image_clear(&im);
    }
    return 0;
}
