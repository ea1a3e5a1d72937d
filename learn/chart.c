/* SPDX-License-Identifier: GPL-3.0-or-later */
/* chart.c - a line chart as an <svg> element. */
#include "learn/chart_priv.h"

#include <math.h>
#include <stdbool.h>

enum { WIDTH = 620, HEIGHT = 260, LEFT = 70, RIGHT = 16, TOP = 28, BOTTOM = 40 };

typedef struct {
    double low, high, step; /* round numbers around the values */
} axis;

static axis round_axis(double low, double high)
{
    if (!(high > low))
        high = low + 1;
    const double raw = (high - low) / 5, power = pow(10, floor(log10(raw)));
    const double step = raw / power <= 1 ? power : raw / power <= 2 ? 2 * power : raw / power <= 5 ? 5 * power : 10 * power;
    return (axis){floor(low / step) * step, ceil(high / step) * step, step};
}

static double place(const axis *a, double v, double from, double to)
{
    return from + (v - a->low) / (a->high - a->low) * (to - from);
}

static void draw_axes(FILE *out, const axis *x, const axis *y)
{
    for (double v = y->low; v <= y->high + y->step / 2; v += y->step) {
        const double at = place(y, v, HEIGHT - BOTTOM, TOP);
        fprintf(out, "<line x1=\"%d\" x2=\"%d\" y1=\"%.1f\" y2=\"%.1f\" stroke=\"#dde\"/>", LEFT, WIDTH - RIGHT, at, at);
        fprintf(out, "<text x=\"%d\" y=\"%.1f\" text-anchor=\"end\">%g</text>\n", LEFT - 6, at + 4, v);
    }
    for (double v = x->low; v <= x->high + x->step / 2; v += x->step)
        fprintf(out, "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%g</text>\n",
                place(x, v, LEFT, WIDTH - RIGHT), HEIGHT - BOTTOM + 16, v);
}

void sg_chart_write(FILE *out, const double *value, size_t n, const char *title, const char *x_title)
{
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < n; i++)
        if (isfinite(value[i])) {
            low = fmin(low, value[i]);
            high = fmax(high, value[i]);
        }
    if (low > high)
        return;
    const axis x = round_axis(0, n > 1 ? (double)(n - 1) : 1), y = round_axis(low, high);
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" font-family=\"sans-serif\" "
            "font-size=\"11\" fill=\"#334\">\n<text x=\"%d\" y=\"16\" font-weight=\"bold\">%s</text>\n",
            WIDTH, HEIGHT, LEFT, title);
    draw_axes(out, &x, &y);
    fprintf(out, "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">%s</text>\n", (LEFT + WIDTH - RIGHT) / 2, HEIGHT - 6,
            x_title);
    fputs("<path fill=\"none\" stroke=\"#1f5fa8\" stroke-width=\"1.8\" d=\"", out);
    bool down = false;
    for (size_t i = 0; i < n; i++) {
        if (isfinite(value[i]))
            fprintf(out, "%c%.1f %.1f", down ? 'L' : 'M', place(&x, (double)i, LEFT, WIDTH - RIGHT),
                    place(&y, value[i], HEIGHT - BOTTOM, TOP));
        down = isfinite(value[i]);
    }
    fputs("\"/>\n</svg>\n", out);
}
