// SPDX-License-Identifier: GPL-3.0-or-later
// cv_draw.cpp - see cv_draw.h.
#include "data/cv_draw.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace {

constexpr int SHIFT = 4; // coordinates in sixteenths of a pixel

cv::Mat view(sg_mask *m)
{
    return cv::Mat(static_cast<int>(m->height), static_cast<int>(m->width), CV_8UC1, m->cover);
}

cv::Point point(double x, double y)
{
    return cv::Point(cvRound(x * (1 << SHIFT)), cvRound(y * (1 << SHIFT)));
}

int whole(double thickness)
{
    return std::max(1, cvRound(thickness));
}

template <class Work> bool guarded(Work work)
{
    try {
        work();
        return true;
    } catch (...) {
        return false;
    }
}

} // namespace

bool sg_cvdraw_polygon(sg_mask *m, const double *xy, size_t n)
{
    return guarded([&] {
        std::vector<cv::Point> points;
        for (size_t i = 0; i < n; i++)
            points.push_back(point(xy[2 * i], xy[2 * i + 1]));
        cv::Mat mask = view(m);
        cv::fillPoly(mask, std::vector<std::vector<cv::Point>>{points}, cv::Scalar(255), cv::LINE_AA, SHIFT);
    });
}

bool sg_cvdraw_line(sg_mask *m, double x0, double y0, double x1, double y1, double thickness)
{
    return guarded([&] {
        cv::Mat mask = view(m);
        cv::line(mask, point(x0, y0), point(x1, y1), cv::Scalar(255), whole(thickness), cv::LINE_AA, SHIFT);
    });
}

bool sg_cvdraw_arc(sg_mask *m, double x, double y, double rx, double ry, double from, double to, double thickness)
{
    return guarded([&] {
        cv::Mat mask = view(m);
        const cv::Size axes(cvRound(rx * (1 << SHIFT)), cvRound(ry * (1 << SHIFT)));
        const int width = thickness > 0 ? whole(thickness) : cv::FILLED;
        cv::ellipse(mask, point(x, y), axes, 0, from, to, cv::Scalar(255), width, cv::LINE_AA, SHIFT);
    });
}

bool sg_cvdraw_text(sg_mask *m, const char *text, double x, double y, double height, double thickness)
{
    return guarded([&] {
        cv::Mat mask = view(m);
        const int font = cv::FONT_HERSHEY_COMPLEX;
        int below = 0;
        const cv::Size unit = cv::getTextSize("H", font, 1.0, 1, &below);
        cv::putText(mask, text, cv::Point(cvRound(x), cvRound(y)), font, height / unit.height, cv::Scalar(255),
                    whole(thickness), cv::LINE_AA);
    });
}

bool sg_cvdraw_blur(float *plane, size_t width, size_t height, int channels, double sigma_px)
{
    return guarded([&] {
        cv::Mat mat(static_cast<int>(height), static_cast<int>(width), CV_MAKETYPE(CV_32F, channels), plane);
        cv::GaussianBlur(mat, mat, cv::Size(0, 0), sigma_px, sigma_px, cv::BORDER_REPLICATE);
    });
}

bool sg_cvdraw_enlarge(const float *from, size_t from_width, size_t from_height, float *to, size_t width, size_t height)
{
    return guarded([&] {
        const cv::Mat source(static_cast<int>(from_height), static_cast<int>(from_width), CV_32FC1,
                             const_cast<float *>(from));
        cv::Mat target(static_cast<int>(height), static_cast<int>(width), CV_32FC1, to);
        cv::resize(source, target, target.size(), 0, 0, cv::INTER_CUBIC);
    });
}

bool sg_cvdraw_photograph(const float *from, size_t from_width, size_t from_height, const double perspective[9],
                          float *to, size_t width, size_t height)
{
    return guarded([&] {
        const cv::Mat source(static_cast<int>(from_height), static_cast<int>(from_width), CV_32FC3,
                             const_cast<float *>(from));
        const cv::Mat map(3, 3, CV_64FC1, const_cast<double *>(perspective));
        cv::Mat seen, target(static_cast<int>(height), static_cast<int>(width), CV_32FC3, to);
        cv::warpPerspective(source, seen, map, source.size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
        cv::resize(seen, target, target.size(), 0, 0, cv::INTER_AREA);
    });
}
