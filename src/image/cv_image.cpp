/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cv_image.cpp - OpenCV behind cv_image.h. Every function works under sg_cv_guarded(), which lets no exception
 * out. */
#include "config.h"

#include "image/cv_image.h"

#include "image/cv_guard.hpp"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <vector>

namespace
{

/* A view of our pixels: no copy. OpenCV's headers know no read-only data; who passes a const picture only reads. */
cv::Mat view(const sg_image *im)
{
    return cv::Mat(static_cast<int>(im->height), static_cast<int>(im->width), CV_8UC3, im->rgb);
}

sg_status encode(const sg_image *im, int quality, uint8_t **bytes, size_t *n, sg_error *err)
{
    cv::Mat bgr;
    cv::cvtColor(view(im), bgr, cv::COLOR_RGB2BGR);
    std::vector<uchar> coded;
    if (!cv::imencode(".jpg", bgr, coded, {cv::IMWRITE_JPEG_QUALITY, quality}))
        return SG_FAIL(err, SG_EINVAL, "the picture cannot be written as JPEG");
    *bytes = static_cast<uint8_t *>(std::malloc(coded.size()));
    if (*bytes == nullptr)
        return SG_FAIL_NOMEM(err);
    std::memcpy(*bytes, coded.data(), coded.size());
    *n = coded.size();
    return SG_OK;
}

/* Area averaging is only right where a side shrinks: the shrinking sides first, then the growing ones. */
sg_status resize(const sg_image *im, sg_image *out)
{
    const cv::Mat from = view(im);
    cv::Mat to = view(out), middle;
    const cv::Size smaller(std::min(from.cols, to.cols), std::min(from.rows, to.rows));
    if (smaller == to.size()) {
        cv::resize(from, to, smaller, 0, 0, cv::INTER_AREA);
        return SG_OK;
    }
    cv::resize(from, middle, smaller, 0, 0, cv::INTER_AREA);
    cv::resize(middle, to, to.size(), 0, 0, cv::INTER_LINEAR);
    return SG_OK;
}

} // namespace

sg_status sg_cv_encode_jpeg(const sg_image *im, int quality, uint8_t **bytes, size_t *n, sg_error *err)
{
    return sg_cv_guarded(err, SG_EINPUT, [&] { return encode(im, quality, bytes, n, err); });
}

sg_status sg_photo_resize(const sg_image *im, size_t width, size_t height, sg_image *out, sg_error *err)
{
    sg_image to;
    SG_TRY(sg_image_create(width, height, &to, err));
    const sg_status st = sg_cv_guarded(err, SG_EINPUT, [&] { return resize(im, &to); });
    if (st == SG_OK)
        *out = to;
    else
        sg_image_clear(&to);
    return st;
}
