/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cv_drawing.cpp - OpenCV behind cv_drawing.h. */
#include "config.h"

#include "image/cv_drawing.h"

#include "image/cv_guard.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace
{

constexpr int SHIFT = 4; /* coordinates in sixteenths of a pixel */

cv::Mat view(sg_image *im)
{
    return cv::Mat(static_cast<int>(im->height), static_cast<int>(im->width), CV_8UC3, im->rgb);
}

/* Pictures are RGB, and OpenCV does not mind. */
cv::Scalar scalar(uint32_t color)
{
    return cv::Scalar(color >> 16 & 255, color >> 8 & 255, color & 255);
}

/* OpenCV's coordinates are those of pixel centres. */
std::vector<cv::Point> points(const double *xy, size_t n)
{
    std::vector<cv::Point> out;
    for (size_t i = 0; i < n; i++)
        out.emplace_back(cvRound((xy[2 * i] - 0.5) * (1 << SHIFT)), cvRound((xy[2 * i + 1] - 0.5) * (1 << SHIFT)));
    return out;
}

/* The Hershey fonts have ASCII only. */
std::string ascii(const char *text)
{
    static const std::string dots = "\xE2\x80\xA6";
    std::string out;
    for (size_t i = 0; text[i] != '\0'; i++) {
        const unsigned char c = static_cast<unsigned char>(text[i]);
        if (dots.compare(0, dots.size(), text + i, std::min(dots.size(), std::char_traits<char>::length(text + i))) == 0) {
            out += "...";
            i += dots.size() - 1;
        } else if (c < 0x80) {
            out += text[i];
        } else if ((c & 0xC0) != 0x80) {
            out += '?';
        }
    }
    return out;
}

sg_status write(sg_image *im, const std::string &text, double x, double y, double letter_px, double width_px, bool from_left,
                uint32_t color)
{
    constexpr double CAPITAL = 21; /* height of a capital of the font at scale 1 */
    constexpr int FONT = cv::FONT_HERSHEY_SIMPLEX;
    int below = 0;
    const double wide = cv::getTextSize(text, FONT, 1, 1, &below).width;
    const double scale = std::min(0.7 * letter_px / CAPITAL, wide > 0 ? width_px / wide : 1.0);
    const int thickness = std::max(1, cvRound(letter_px / 16));
    const double left = from_left ? x : x + (width_px - wide * scale) / 2;
    cv::Mat mat = view(im);
    cv::putText(mat, text, cv::Point(cvRound(left), cvRound(y + CAPITAL * scale / 2)), FONT, scale, scalar(color), thickness,
                cv::LINE_AA);
    return SG_OK;
}

} // namespace

sg_status sg_cv_fill(sg_image *im, const double *xy, size_t n, uint32_t color, sg_error *err)
{
    return sg_cv_guarded(err, SG_EINVAL, [&] {
        const std::vector<cv::Point> p = points(xy, n);
        cv::Mat mat = view(im);
        cv::fillConvexPoly(mat, p.data(), static_cast<int>(n), scalar(color), cv::LINE_AA, SHIFT);
        return SG_OK;
    });
}

sg_status sg_cv_stroke(sg_image *im, const double *xy, size_t n, bool closed, double width_px, uint32_t color, sg_error *err)
{
    return sg_cv_guarded(err, SG_EINVAL, [&] {
        const std::vector<std::vector<cv::Point>> p{points(xy, n)};
        cv::Mat mat = view(im);
        cv::polylines(mat, p, closed, scalar(color), std::max(1, cvRound(width_px)), cv::LINE_AA, SHIFT);
        return SG_OK;
    });
}

sg_status sg_cv_text(sg_image *im, const char *text, double x, double y, double letter_px, double width_px, bool from_left,
                     uint32_t color, sg_error *err)
{
    return sg_cv_guarded(err, SG_EINVAL,
                         [&] { return write(im, ascii(text), x, y, letter_px, width_px, from_left, color); });
}
