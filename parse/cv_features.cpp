/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cv_features.cpp - OpenCV behind cv_features.h. */
#include "config.h"

#include "parse/cv_features.h"

#include "image/cv_guard.hpp"

#include <opencv2/imgproc.hpp>

namespace
{

constexpr int border = cv::BORDER_REPLICATE;

cv::Mat view(sg_plane p)
{
    return cv::Mat(static_cast<int>(p.height), static_cast<int>(p.width), CV_32FC1, p.at, p.stride * sizeof(float));
}

/* The filter writes where it is told to: a Mat of our memory, of its size and type, is not made anew. */
template <typename Filter> sg_status filter(sg_plane from, sg_plane to, sg_error *err, Filter work)
{
    return sg_cv_guarded(err, SG_ENUMERIC, [&] {
        const cv::Mat in = view(from);
        cv::Mat out = view(to);
        work(in, out);
        return SG_OK;
    });
}

sg_status convert(const sg_image *photo, int code, const sg_plane (&planes)[3], sg_error *err)
{
    return sg_cv_guarded(err, SG_ENUMERIC, [&] {
        const cv::Mat rgb(static_cast<int>(photo->height), static_cast<int>(photo->width), CV_8UC3, photo->rgb);
        cv::Mat converted;
        rgb.convertTo(converted, CV_32FC3, 1.0 / 255);
        cv::cvtColor(converted, converted, code);
        for (int c = 0; c < 3; c++) {
            cv::Mat out = view(planes[c]);
            cv::extractChannel(converted, out, c);
        }
        return SG_OK;
    });
}

} // namespace

sg_status sg_cv_lab(const sg_image *photo, sg_plane lightness, sg_plane a, sg_plane b, sg_error *err)
{
    return convert(photo, cv::COLOR_RGB2Lab, {lightness, a, b}, err);
}

sg_status sg_cv_hsv(const sg_image *photo, sg_plane hue, sg_plane saturation, sg_plane value, sg_error *err)
{
    return convert(photo, cv::COLOR_RGB2HSV, {hue, saturation, value}, err);
}

sg_status sg_cv_gaussian(sg_plane from, sg_plane to, double sigma, sg_error *err)
{
    return filter(from, to, err, [=](const cv::Mat &in, cv::Mat &out) {
        cv::GaussianBlur(in, out, cv::Size(0, 0), sigma, sigma, border);
    });
}

sg_status sg_cv_derivative(sg_plane from, sg_plane to, int dx, int dy, sg_error *err)
{
    return filter(from, to, err,
                  [=](const cv::Mat &in, cv::Mat &out) { cv::Scharr(in, out, CV_32F, dx, dy, 1.0 / 32, 0, border); });
}

sg_status sg_cv_laplacian(sg_plane from, sg_plane to, sg_error *err)
{
    return filter(from, to, err,
                  [](const cv::Mat &in, cv::Mat &out) { cv::Laplacian(in, out, CV_32F, 1, 1, 0, border); });
}

sg_status sg_cv_box_mean(sg_plane from, sg_plane to, size_t width, size_t height, sg_error *err)
{
    const cv::Size box(static_cast<int>(width), static_cast<int>(height));
    return filter(from, to, err, [=](const cv::Mat &in, cv::Mat &out) {
        cv::boxFilter(in, out, CV_32F, box, cv::Point(-1, -1), true, border);
    });
}
